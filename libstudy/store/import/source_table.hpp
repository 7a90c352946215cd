#pragma once
/// A CSV file of another program, in memory.

#include <filesystem>
#include <string>
#include <vector>

namespace study {

/// A table with named columns. Fields are separated by commas, semicolons or tabs, and may be quoted as in
/// RFC 4180, with line breaks and doubled quotes inside.
class SourceTable {
 public:
  struct Row {
    int line = 0;  ///< line of the file on which the row begins, from 1
    std::vector<std::string> fields;
  };

  /// Reads the file. A byte-order mark, empty lines, and a separator at the end of each line (as PsychoPy
  /// writes it) are accepted. base::Error at file:line for text that is not UTF-8, a quote that is not
  /// closed, and rows with more or fewer fields than the first line has names.
  explicit SourceTable(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  const std::string& sha256() const { return sha256_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<Row>& rows() const { return rows_; }
  bool decimal_commas() const { return separator_ != ','; }

  /// Index of a column. base::Error if no column, or more than one, has this name.
  std::size_t place_of(const std::string& column) const;
  /// "file:line" of a row.
  std::string place(const Row& row) const;

 private:
  std::vector<Row> split(const std::string& text) const;

  std::filesystem::path file_;
  std::string sha256_;
  char separator_ = ',';
  std::vector<std::string> names_;
  std::vector<Row> rows_;
};

}  // namespace study
