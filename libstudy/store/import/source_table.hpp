#pragma once
/// A CSV file of another program, with the hash of its bytes.

#include <filesystem>
#include <string>
#include <vector>

#include "stats/base/csv.hpp"

namespace study {

class SourceTable {
 public:
  using Row = base::CsvRow;

  /// Reads the file as base::CsvTable does.
  explicit SourceTable(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  const std::string& sha256() const { return sha256_; }
  const std::vector<std::string>& names() const { return table_.columns(); }
  const std::vector<Row>& rows() const { return table_.rows(); }
  bool decimal_commas() const { return table_.separator() != ','; }

  /// Index of a column that the mapping names. base::Error if no column, or more than one, has this name.
  std::size_t place_of(const std::string& column) const;
  /// "file:line" of a row.
  std::string place(const Row& row) const;

 private:
  SourceTable(const std::filesystem::path& file, const std::string& text);

  std::filesystem::path file_;
  std::string sha256_;
  base::CsvTable table_;
};

}  // namespace study
