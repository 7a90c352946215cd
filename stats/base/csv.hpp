#pragma once
/// Tables in CSV files whose first line names the columns (RFC 4180).

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace base {

/// One row of a table: a field for each column.
struct CsvRow {
  int line = 0;  ///< line of the file on which the row begins, from 1
  std::vector<std::string> fields;
};

/// A table in UTF-8. Commas separate fields; if the first line has none outside quotes, semicolons or tabs
/// do. Fields in quotes may hold separators, line ends, and quotes written twice. Spaces and tabs around a
/// field without quotes are left out, as are blank lines, a byte-order mark, and a last column without a name
/// whose fields are empty, which separators at the ends of the lines make.
///
///   const base::CsvTable table("choices.csv");
///   const std::size_t person = table.column("person");
///   for (const base::CsvRow& row : table.rows()) use(row.fields[person]);
class CsvTable {
 public:
  /// Reads a file of at most 256 MiB. base::Error at file:line: the file cannot be read, is empty, is not in
  /// UTF-8, ends in quotes; a row with more or fewer fields than columns.
  explicit CsvTable(const std::filesystem::path& file);
  /// Reads the text of a file. `file`: its name, for messages.
  CsvTable(std::string file, const std::string& text);

  const std::string& file() const { return file_; }
  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<CsvRow>& rows() const { return rows_; }
  char separator() const { return separator_; }  ///< of fields: ',', ';' or a tab

  /// The place of the column with this name. base::Error if several columns have it.
  std::optional<std::size_t> find(const std::string& name) const;
  /// The same. base::Error if there is no such column.
  std::size_t column(const std::string& name) const;

  /// Throws base::Error at the row's line.
  [[noreturn]] void fail(const CsvRow& row, const std::string& problem, const std::string& mend) const;

 private:
  std::string file_;
  char separator_ = ',';
  std::vector<std::string> columns_;
  std::vector<CsvRow> rows_;
};

}  // namespace base
