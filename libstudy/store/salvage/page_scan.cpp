#include "libstudy/store/salvage/page_scan.hpp"

#include <bit>
#include <optional>
#include <string_view>

#include "libstudy/store/file/page_file.hpp"

// The format of a database's pages: https://www.sqlite.org/fileformat2.html
namespace study::salvaging {

namespace fs = std::filesystem;
using sqlite::Statement;

namespace {

constexpr std::size_t most_payload_bytes = std::size_t{1} << 30;

/// Reads bytes in sequence, among them SQLite's variable-length integers of one to nine bytes. Returns none
/// past the end.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}
  std::size_t at() const { return at_; }

  std::optional<std::uint64_t> number() {
    std::uint64_t value = 0;
    for (int i = 0; i < 9; ++i) {
      if (at_ >= bytes_.size()) return {};
      const auto byte = static_cast<unsigned char>(bytes_[at_++]);
      if (i == 8) return value << 8 | byte;
      value = value << 7 | (byte & 0x7f);
      if (byte < 0x80) return value;
    }
    return {};
  }

  std::optional<std::string_view> take(std::size_t count) {
    if (count > bytes_.size() || at_ > bytes_.size() - count) return {};
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }

 private:
  std::string_view bytes_;
  std::size_t at_;
};

/// Limit on the number of overflow pages that are read: 16 times the number of pages in the file. In a sound
/// file each overflow page belongs to one row, but in a forged file every cell could point to all of them.
/// Rows beyond the limit are omitted.
class Allowance {
 public:
  explicit Allowance(std::size_t pages) : left_(most_readings * pages) {}
  bool take_one() { return left_ > 0 && left_-- > 0; }

 private:
  static constexpr std::size_t most_readings = 16;
  std::size_t left_;
};

/// The record in a cell (an entry of a B-tree page), including its overflow pages; none if it is damaged or
/// the allowance is used up. table: true for a table with row numbers, false for a table WITHOUT ROWID.
std::optional<std::string> payload_at(const Pages& pages, std::string_view page, Cursor cell,
                                      std::uint64_t size, bool table, Allowance& allowance) {
  const std::size_t usable = pages.usable();
  const std::size_t most = table ? usable - 35 : (usable - 12) * 64 / 255 - 23;
  const std::size_t least = (usable - 12) * 32 / 255 - 23;
  if (size > most_payload_bytes) return {};
  if (size <= most) {
    const auto all = cell.take(size);
    if (!all) return {};
    return std::string(*all);
  }
  const std::size_t fits = least + (size - least) % (usable - 4);
  const auto here = cell.take(fits <= most ? fits : least);
  if (!here) return {};
  std::string payload(*here);
  std::size_t next = u32(page, cell.at());
  for (std::size_t steps = 0; payload.size() < size; ++steps) {
    if (next < 2 || next > pages.count() || steps > pages.count() || !allowance.take_one()) return {};
    const std::string more = pages.read(next);
    if (more.size() < usable) return {};
    payload += more.substr(4, std::min(usable - 4, size - payload.size()));
    next = u32(more, 0);
  }
  return payload;
}

std::optional<Value> value_of(std::uint64_t type, Cursor& body) {
  constexpr std::size_t bytes_of[] = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
  if (type >= 12) {
    const auto text = body.take((type - 12) / 2);
    if (!text || type % 2 == 0) return {};  // even types are blobs, which no table of vip-study has
    return Value(std::string(*text));
  }
  if (type >= 10) return {};
  const auto bytes = body.take(bytes_of[type]);
  if (!bytes) return {};
  if (type == 0) return Value();
  if (type >= 8) return Value(static_cast<std::int64_t>(type - 8));
  const std::uint64_t bits = big_endian(*bytes);
  if (type == 7) return Value(std::bit_cast<double>(bits));
  const unsigned unused = static_cast<unsigned>(64 - 8 * bytes->size());
  return Value(static_cast<std::int64_t>(bits << unused) >> unused);
}

std::optional<Values> record(std::string_view payload) {
  Cursor head(payload);
  const auto head_size = head.number();
  if (!head_size || *head_size > payload.size()) return {};
  Cursor body(payload, *head_size);
  Values values;
  while (head.at() < *head_size) {
    const auto type = head.number();
    if (!type || head.at() > *head_size) return {};
    auto value = value_of(*type, body);
    if (!value) return {};
    values.push_back(std::move(*value));
  }
  if (body.at() != payload.size()) return {};
  return values;
}

bool is_time(const std::string& text) { return text.size() >= 10 && text[4] == '-' && text[7] == '-'; }

bool fits(const Shape::Column& column, const Value& value) {
  if (std::holds_alternative<std::monostate>(value)) return column.may_be_null;
  if (column.type == "TEXT") {
    const auto* text = std::get_if<std::string>(&value);
    return text && (!column.name.ends_with("utc") || is_time(*text));
  }
  const bool whole = std::holds_alternative<std::int64_t>(value);
  return column.type == "INTEGER" ? whole : whole || std::holds_alternative<double>(value);
}

bool fits(const Shape& shape, const Values& values) {
  if (values.size() != shape.columns.size()) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    // SQLite stores the row number before the record; the record has NULL in the row number's column.
    const bool number = static_cast<int>(i) == shape.row_number_column;
    if (number ? !std::holds_alternative<std::monostate>(values[i]) : !fits(shape.columns[i], values[i]))
      return false;
  }
  return true;
}

/// Calls `take` for each row on one page that fits a shape; does nothing if the page has no rows.
void scan_page(const Pages& pages, std::size_t number, const std::vector<Shape>& shapes, Allowance& allowance,
               const std::function<void(const Shape&, Values)>& take) {
  const std::string page = pages.read(number);
  const std::size_t start = number == 1 ? header_bytes : 0;
  if (page.size() < start + 8) return;
  const int type = static_cast<unsigned char>(page[start]);
  const bool table = type == 0x0d, inner = type == 0x02;
  if (!table && !inner && type != 0x0a) return;
  const std::size_t cells = big_endian(std::string_view(page).substr(start + 3, 2));
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t pointer = start + (inner ? 12 : 8) + 2 * i;
    if (pointer + 2 > page.size()) return;
    Cursor cell(page, big_endian(std::string_view(page).substr(pointer, 2)) + (inner ? 4 : 0));
    const auto size = cell.number();
    const auto row = table ? cell.number() : std::optional<std::uint64_t>(0);
    if (!size || !row) continue;
    const auto payload = payload_at(pages, page, cell, *size, table, allowance);
    auto values = payload ? record(*payload) : std::nullopt;
    if (!values) continue;
    for (const Shape& shape : shapes) {
      if (shape.row_numbers != table || !fits(shape, *values)) continue;
      if (shape.row_number_column >= 0)
        (*values)[static_cast<std::size_t>(shape.row_number_column)] = static_cast<std::int64_t>(*row);
      take(shape, std::move(*values));
      break;
    }
  }
}

}  // namespace

std::vector<Shape> shapes_of(sqlite::Connection& database) {
  std::vector<Shape> shapes;
  Statement table(database,
                  "SELECT name, wr FROM pragma_table_list WHERE schema = 'main' AND type = 'table' "
                  "AND name NOT LIKE 'sqlite_%'");
  Statement column(database, "SELECT name, type, \"notnull\", pk FROM pragma_table_info(?)");
  while (table.step()) {
    Shape shape{table.text(0), {}, table.integer(1) == 0, -1};
    for (column.bind_all(shape.table); column.step();) {
      if (shape.row_numbers && column.integer(3) > 0 && column.text(1) == "INTEGER")
        shape.row_number_column = static_cast<int>(shape.columns.size());
      shape.columns.push_back({column.text(0), column.text(1), column.integer(2) == 0});
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

void scan_pages(const fs::path& file, const std::vector<Shape>& shapes,
                const std::function<void(const Shape&, Values)>& take, bool use_log) {
  const Pages pages(file, use_log);
  Allowance allowance(pages.count());
  for (std::size_t number = 1; number <= pages.count(); ++number) {
    if (!pages.is_free(number)) scan_page(pages, number, shapes, allowance, take);
  }
}

}  // namespace study::salvaging
