#include "stats/base/csv.hpp"

#include <algorithm>
#include <utility>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace base {

namespace {

constexpr std::size_t most_csv_bytes = std::size_t{1} << 28;

/// Splits the text of a file into rows.
class CsvReader {
 public:
  CsvReader(const std::string& file, const std::string& text) : file_(file), text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) place_ = 3;
    for (std::size_t i = place_; i < text_.size();) {
      const std::size_t length = utf8_length(std::string_view(text_).substr(i, 4));
      const bool control = static_cast<unsigned char>(text_[i]) < 32 && text_[i] != '\n' &&
                           text_[i] != '\r' && text_[i] != '\t';
      if (length == 0 || control)
        throw Error(
            file_ + ":" + std::to_string(1 + std::count(text_.begin(), text_.begin() + as_offset(i), '\n')),
            "is no text in UTF-8", "save the table as CSV in UTF-8");
      i += length;
    }
    separator_ = separator_of_first_line();
  }

  char separator() const { return separator_; }

  /// Sets `row` to the next row that is not blank; false at the end.
  bool next(CsvRow& row) {
    while (place_ < text_.size()) {
      row = {line_, {}};
      bool quoted = false;
      do {
        row.fields.push_back(field(quoted));
      } while (take(separator_));
      end_of_line();
      if (row.fields.size() > 1 || quoted || !row.fields.front().empty()) return true;
    }
    return false;
  }

 private:
  static std::ptrdiff_t as_offset(std::size_t i) { return static_cast<std::ptrdiff_t>(i); }

  char separator_of_first_line() const {
    bool quoted = false;
    char other = ',';
    for (std::size_t i = place_; i < text_.size(); ++i) {
      const char c = text_[i];
      if (c == '"') quoted = !quoted;
      if (quoted) continue;
      if (c == '\n' && i > place_) break;
      if (c == ',') return ',';
      if (other == ',' && (c == ';' || c == '\t')) other = c;
    }
    return other;
  }

  bool take(char c) {
    if (place_ >= text_.size() || text_[place_] != c) return false;
    ++place_;
    return true;
  }

  void end_of_line() {
    take('\r');
    if (take('\n')) ++line_;
  }

  void skip_spaces() {
    while (place_ < text_.size() && (text_[place_] == ' ' || text_[place_] == '\t') &&
           text_[place_] != separator_)
      ++place_;
  }

  bool at_end_of_field() const {
    return place_ >= text_.size() || text_[place_] == separator_ || text_[place_] == '\n' ||
           text_[place_] == '\r';
  }

  std::string field(bool& quoted) {
    skip_spaces();
    std::string out;
    if (!take('"')) {
      while (!at_end_of_field()) out += text_[place_++];
      out.erase(out.find_last_not_of(" \t") + 1);
      return out;
    }
    quoted = true;
    const int opened = line_;
    while (true) {
      if (place_ >= text_.size())
        throw Error(file_ + ":" + std::to_string(opened), "opens a quote that nothing closes",
                    "close the quote; write a quote within a field twice");
      const char c = text_[place_++];
      if (c == '"' && !take('"')) break;
      if (c == '\n') ++line_;
      out += c;
    }
    skip_spaces();
    if (!at_end_of_field())
      throw Error(file_ + ":" + std::to_string(line_), "has text after a closing quote",
                  "put quotes around the whole field; write a quote within a field twice");
    return out;
  }

  std::string file_;
  const std::string& text_;
  std::size_t place_ = 0;
  int line_ = 1;
  char separator_ = ',';
};

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file)
    : CsvTable(file.string(), read_file(file, most_csv_bytes)) {}

CsvTable::CsvTable(std::string file, const std::string& text) : file_(std::move(file)) {
  CsvReader reader(file_, text);
  CsvRow row;
  if (!reader.next(row)) throw Error(file_, "is empty", "give a table whose first line names the columns");
  separator_ = reader.separator();
  columns_ = row.fields;
  const bool open_end = columns_.size() > 1 && columns_.back().empty();
  if (open_end) columns_.pop_back();
  for (const std::string& name : columns_)
    if (!is_plain_line(name)) fail(row, "names a column in several lines", "use names of one line");
  while (reader.next(row)) {
    if (open_end && row.fields.size() == columns_.size() + 1 && row.fields.back().empty())
      row.fields.pop_back();
    if (row.fields.size() != columns_.size())
      fail(row,
           "has " + std::to_string(row.fields.size()) + " fields where " + std::to_string(columns_.size()) +
               " belong",
           "give each row a field for each column; put quotes around a field that holds a separator");
    rows_.push_back(std::move(row));
  }
}

std::optional<std::size_t> CsvTable::find(const std::string& name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  if (found == columns_.end()) return {};
  if (std::find(found + 1, columns_.end(), name) != columns_.end())
    throw Error(file_ + ":1", "names the column " + shortened(name) + " twice",
                "give each column a name of its own");
  return static_cast<std::size_t>(found - columns_.begin());
}

std::size_t CsvTable::column(const std::string& name) const {
  if (const auto place = find(name)) return *place;
  std::vector<std::string> shown;
  for (const std::string& one : columns_) shown.push_back(shortened(one, 40));
  throw Error(file_ + ":1", "has no column " + shortened(name), use_one_of(name, shown));
}

void CsvTable::fail(const CsvRow& row, const std::string& problem, const std::string& mend) const {
  throw Error(file_ + ":" + std::to_string(row.line), problem, mend);
}

}  // namespace base
