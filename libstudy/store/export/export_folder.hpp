#pragma once
/// Export folders: written completely beside the target, then put in place by one rename.

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

/// A file of an export.
struct ExportedFile {
  std::string name;
  std::int64_t rows = 0;
};

/// Who may read an export; the folders of Readers::Owner are 0700.
using base::Readers;

/// An export that others may read, with the number of people in it and left out.
struct PublicExport {
  std::vector<ExportedFile> files;
  SharingCount people;
};

/// A kind of export folder. The functions recognise folders of earlier versions, which have no list of files.
struct ExportKind {
  const char* name;                                 ///< csv, bids, psych-ds
  bool (*is_export)(const std::filesystem::path&);  ///< true if this program wrote the folder
  bool (*is_name)(const std::string&);              ///< true if such a folder may hold a file of that name
};

/// Format of the CSV files of an export.
struct CsvDialect {
  char separator = ',';
  char decimal = '.';  ///< in numbers that are not integers
  bool mark = false;   ///< begin with a byte-order mark, so that spreadsheets detect UTF-8
};

/// The dialect that a spreadsheet opens correctly in this computer's locale (LC_ALL, LC_NUMERIC or LANG): a
/// byte-order mark, and semicolons if the decimal mark is a comma. base::Error: that locale is not installed.
CsvDialect excel_dialect();

/// The source of an export and its readers.
struct ExportSource {
  std::filesystem::path database;
  const ExportKind& kind;
  std::set<std::string> people;  ///< people in the export (session.person)
  Readers readers;
  CsvDialect dialect = {};
};

/// A draft folder beside the target, deleted unless put in place, so that the target is never partial. It is
/// registered in the database before it is made.
class ExportDraft {
 public:
  /// base::Error, with nothing made, if the target is anything but absent, an empty folder or an unchanged
  /// earlier export of that kind (the error names the added or changed file), or if the database cannot be
  /// written (RegisteredExport).
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
  /// export. Returns once it is on disk. base::Error, with the target deleted, if one of its people withdrew
  /// meanwhile.
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

/// A file of a draft; makes its parent folders. base::Error if not every byte reached the disk, or if the
/// name leads out of the draft or is not portable (base::check_file_name).
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

/// Writes a whole file of a draft.
void write_file(const ExportDraft& draft, const std::string& name, const std::string& text);

/// Prefixes an apostrophe if a spreadsheet would read the text as a formula: if it begins with = + - @ (also
/// in full width), a tab or a line end, or with apostrophes and one of these. A reader restores the text by
/// removing one apostrophe from fields that begin with apostrophes and one of these.
std::string formula_guarded(const std::string& text);
/// The same rule as text for the descriptions of an export.
extern const char* const formula_guard_meaning;
/// A text as a CSV field: formula_guarded(), quoted if RFC 4180 requires it or if it was guarded.
std::string csv_field(const std::string& text, const CsvDialect& dialect = {});
/// The shortest text that parses to the same number.
std::string number_text(double value);
/// A number's text with the dialect's decimal mark.
std::string csv_number(std::string text, const CsvDialect& dialect);
/// A column's value: a text as csv_field(), a number as csv_number(), empty for NULL.
std::string csv_value(const sqlite::Statement& row, int column, const CsvDialect& dialect = {});
/// Joins finished fields to a line.
std::string csv_line(const std::vector<std::string>& fields, const CsvDialect& dialect);
/// The byte-order mark, if any, and the header line.
std::string csv_head(const std::vector<std::string>& names, const CsvDialect& dialect);
/// Writes the rows that `sql` selects under a header line; returns their number.
std::int64_t write_csv(sqlite::Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name);

}  // namespace study
