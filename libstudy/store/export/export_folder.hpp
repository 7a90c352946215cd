#pragma once
/// Writes export folders: completely beside the target, then renamed to it, so that the target is never
/// partial.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/export_register.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/permissions.hpp"
#include "stats/base/new_file.hpp"

namespace study {

/// A file of an export, with its number of rows.
struct ExportedFile {
  std::string name;
  std::int64_t rows = 0;
};

/// Who may read an export. Readers::Owner: its folders have mode 0700. Readers::AsUmask: the umask decides.
using base::Readers;

/// The result of a public export: its files, and the numbers of people that it includes and omits.
struct PublicExport {
  std::vector<ExportedFile> files;
  SharingCount people;
};

/// A kind of export folder. Its functions recognise folders that earlier versions wrote, which have no list
/// of files.
struct ExportKind {
  const char* name;                                 ///< "csv", "bids" or "psych-ds"
  bool (*is_export)(const std::filesystem::path&);  ///< true if vip-study wrote the folder
  bool (*is_name)(const std::string&);              ///< true if this kind of export has files of this name
};

/// Format of the CSV files of an export.
struct CsvDialect {
  char separator = ',';
  char decimal = '.';  ///< decimal mark of numbers that are not integers
  bool mark = false;   ///< true: begin with a byte-order mark, by which spreadsheets detect UTF-8
};

/// The dialect that a spreadsheet opens correctly in this computer's locale (LC_ALL, LC_NUMERIC or LANG). It
/// has a byte-order mark and, if the locale's decimal mark is a comma, decimal commas and semicolons between
/// fields. base::Error if the locale is not installed.
CsvDialect excel_dialect();

/// The source, people, readers and dialect of an export.
struct ExportSource {
  std::filesystem::path database;
  const ExportKind& kind;
  std::set<std::string> people;  ///< persons (session.person) whose data the export contains
  Readers readers;
  CsvDialect dialect = {};
};

/// The draft of an export: a folder beside the target, registered in the database before it is made. The
/// destructor deletes the draft unless put_in_place() renamed it.
class ExportDraft {
 public:
  /// Makes the draft. The target must be absent, an empty folder, or an unchanged earlier export of the same
  /// kind. base::Error, with nothing made, if the target is anything else (the error names an added or
  /// changed file), or if the database cannot be written (RegisteredExport).
  ExportDraft(const ExportSource& source, const std::filesystem::path& target);
  ~ExportDraft();
  ExportDraft(const ExportDraft&) = delete;
  ExportDraft& operator=(const ExportDraft&) = delete;

  /// The target of the export, as an absolute path.
  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }
  Readers readers() const { return readers_; }
  const CsvDialect& dialect() const { return dialect_; }
  /// Adds the list of files (own_exports.hpp) and renames the draft to the target, replacing an earlier
  /// export. Returns once the rename is on disk. base::Error, with the new export deleted, if a person in the
  /// export withdrew in the meantime.
  void put_in_place();

 private:
  void replace_target();
  bool replace_in_two_steps();
  [[noreturn]] void fail(const std::string& problem);

  std::filesystem::path target_, path_;
  const ExportKind& kind_;
  Readers readers_;
  CsvDialect dialect_;
  std::optional<RegisteredExport> record_;
};

/// Writes a file of a draft, and makes its parent folders. base::Error if the file cannot be written to disk
/// completely, or if its name leads out of the draft or is not portable (base::check_file_name()).
class ExportFile {
 public:
  ExportFile(const ExportDraft& draft, const std::string& name);
  ~ExportFile();
  ExportFile(const ExportFile&) = delete;
  ExportFile& operator=(const ExportFile&) = delete;

  void write(const std::string& text);
  void finish();

 private:
  [[noreturn]] void fail() const;

  std::string shown_;
  std::FILE* file_ = nullptr;
};

/// Writes a file of a draft with the content `text`.
void write_file(const ExportDraft& draft, const std::string& name, const std::string& text);

/// Puts an apostrophe before a text that a spreadsheet would read as a formula. Such a text begins with = + -
/// @ (also as full-width characters), a tab or a line end, or with apostrophes followed by one of these. A
/// reader restores the text by removing one apostrophe if the field begins with apostrophes followed by one
/// of these.
std::string formula_guarded(const std::string& text);
/// The rule of formula_guarded() in words, for the descriptions in exports.
extern const char* const formula_guard_meaning;
/// A text as a CSV field: formula_guarded(), and quoted if RFC 4180 requires it or if it got an apostrophe.
std::string csv_field(const std::string& text, const CsvDialect& dialect = {});
/// The shortest text that parses to the same number.
std::string number_text(double value);
/// A number as text with the dialect's decimal mark instead of the decimal point of `text`.
std::string csv_number(std::string text, const CsvDialect& dialect);
/// A column of a result row as a CSV field: a text as csv_field(), a number as csv_number(), NULL as empty.
std::string csv_value(const sqlite::Statement& row, int column, const CsvDialect& dialect = {});
/// Joins fields, which must be quoted already, to a line, and appends the line end.
std::string csv_line(const std::vector<std::string>& fields, const CsvDialect& dialect);
/// The beginning of a CSV file: the byte-order mark if the dialect has one, then the header line.
std::string csv_head(const std::vector<std::string>& names, const CsvDialect& dialect);
/// Writes a CSV file of a draft: a header line and the rows that `sql` selects. Returns the number of rows.
std::int64_t write_csv(sqlite::Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name);

}  // namespace study
