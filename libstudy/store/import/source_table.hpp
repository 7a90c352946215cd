#pragma once
/// A table of another program, in CSV or JSON, with the hash of its bytes.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "stats/base/csv.hpp"

namespace study {

class SourceTable {
 public:
  using Row = base::CsvRow;

  /// Reads the file as base::CsvTable does. A file whose name ends in ".json" holds a list of objects, one
  /// for each row, such as jsPsych writes: the columns are the keys of all objects. Text stands as it is;
  /// null and a missing key are empty; an object or a list is its JSON text. base::Error for a file that is
  /// no such list, such as one that was cut, or is larger than 32 MiB.
  explicit SourceTable(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  const std::string& sha256() const { return sha256_; }
  const std::vector<std::string>& names() const { return csv_ ? csv_->columns() : names_; }
  const std::vector<Row>& rows() const { return csv_ ? csv_->rows() : rows_; }
  bool decimal_commas() const { return csv_ && csv_->separator() != ','; }

  /// Index of a column that the mapping names. base::Error if no column, or more than one, has this name.
  std::size_t place_of(const std::string& column) const;
  /// "file:line" of a row; of JSON "file: entry N".
  std::string place(const Row& row) const;

 private:
  void read_json(const std::string& text);

  std::filesystem::path file_;
  std::string sha256_;
  std::optional<base::CsvTable> csv_;
  /// Of JSON: names of the columns, and rows, whose line is the number of the entry, from 1.
  std::vector<std::string> names_;
  std::vector<Row> rows_;
};

}  // namespace study
