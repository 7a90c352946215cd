#include "libstudy/store/import/source_table.hpp"

#include <algorithm>
#include <string_view>

#include "libstudy/pacing/capture_table.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::size_t most_source_bytes = 1 << 28;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

[[noreturn]] void fail_at(const std::filesystem::path& file, int line, const std::string& problem,
                          const std::string& mend) {
  throw base::Error(file.string() + ":" + std::to_string(line), problem, mend);
}

void check_text(const std::filesystem::path& file, std::string_view text) {
  int line = 1;
  while (!text.empty()) {
    const std::size_t bytes = base::utf8_length(text);
    if (bytes == 0 || text.front() == '\0')
      fail_at(file, line, "is no text in UTF-8", "save the table as CSV in UTF-8");
    line += text.front() == '\n';
    text.remove_prefix(bytes);
  }
}

bool is_blank_row(const SourceTable::Row& row) {
  return row.fields.size() == 1 && base::is_blank(row.fields[0]);
}

}  // namespace

SourceTable::SourceTable(const std::filesystem::path& file) : file_(file) {
  std::string text = base::read_file(file, most_source_bytes);
  sha256_ = base::sha256_hex(text);
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  check_text(file, text);
  separator_ = separator_of(text.substr(0, text.find('\n')));
  rows_ = split(text);
  std::erase_if(rows_, is_blank_row);
  if (rows_.empty()) fail_at(file, 1, "is empty", "give the table that the program wrote");
  const int head_line = rows_.front().line;
  names_ = std::move(rows_.front().fields);
  rows_.erase(rows_.begin());
  const bool trailing = names_.size() > 1 && names_.back().empty();
  if (trailing) names_.pop_back();
  for (const std::string& name : names_)
    if (!base::is_plain_line(name))
      fail_at(file, head_line, "a name of a column holds a control character",
              "name the columns in one line");
  for (Row& row : rows_) {
    if (trailing && row.fields.size() == names_.size() + 1 && row.fields.back().empty())
      row.fields.pop_back();
    if (row.fields.size() != names_.size())
      fail_at(file, row.line,
              "has " + std::to_string(row.fields.size()) + " fields where the first line names " +
                  std::to_string(names_.size()) + " columns",
              "export the table again; a field with the separator in it needs quotes");
  }
}

std::vector<SourceTable::Row> SourceTable::split(const std::string& text) const {
  std::vector<Row> rows;
  int line = 1;
  std::size_t at = 0;
  while (at < text.size()) {
    Row row{line, {""}};
    bool quoted = false, closed = false;  // closed: the field's quote has ended
    for (bool over = false; !over && at < text.size(); ++at) {
      const char c = text[at];
      line += c == '\n';
      if (quoted) {
        if (c != '"')
          row.fields.back() += c;
        else if (at + 1 < text.size() && text[at + 1] == '"')
          row.fields.back() += text[++at];
        else
          quoted = false, closed = true;
      } else if (c == separator_) {
        row.fields.emplace_back();
        closed = false;
      } else if (c == '\n') {
        over = true;
      } else if (c == '\r' && (at + 1 == text.size() || text[at + 1] == '\n')) {
        continue;
      } else if (c == '"' && row.fields.back().empty() && !closed) {
        quoted = true;
      } else if (closed) {
        fail_at(file_, line, "has text after the end of a quoted field",
                "double each quote within a quoted field, as in \"a \"\"b\"\"\"");
      } else {
        row.fields.back() += c;
      }
    }
    if (quoted) fail_at(file_, row.line, "begins a quoted field that is not closed", "close the quote");
    rows.push_back(std::move(row));
  }
  return rows;
}

std::size_t SourceTable::place_of(const std::string& column) const {
  const auto found = std::find(names_.begin(), names_.end(), column);
  if (found == names_.end())
    throw base::Error(file_.string(), "has no column " + base::shortened(column),
                      "correct the mapping: " + base::use_one_of(column, names_));
  if (std::count(names_.begin(), names_.end(), column) > 1)
    throw base::Error(file_.string(), "names the column " + base::shortened(column) + " more than once",
                      "give the columns distinct names");
  return static_cast<std::size_t>(found - names_.begin());
}

std::string SourceTable::place(const Row& row) const {
  return file_.string() + ":" + std::to_string(row.line);
}

}  // namespace study
