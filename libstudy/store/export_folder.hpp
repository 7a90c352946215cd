#pragma once
/// Folders of exports: made whole beside their place, then put there by one rename.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/export_register.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/sqlite.hpp"
#include "stats/base/new_file.hpp"

namespace study {

/// A file of an export.
struct ExportedFile {
  std::string name;
  std::int64_t rows = 0;
};

/// Who may read an export; the folders of Readers::Owner are 0700.
using base::Readers;

/// An export that others may read, and whom it leaves out.
struct PublicExport {
  std::vector<ExportedFile> files;
  SharingCount people;
};

/// A kind of folder, and how one is known that an earlier version wrote, without a list of its files.
struct ExportKind {
  const char* name;                                 ///< csv, bids, psych-ds
  bool (*is_export)(const std::filesystem::path&);  ///< whether a folder was written by this program
  bool (*is_name)(const std::string&);              ///< whether a file of that name may be of it
};

/// How the CSV files of an export are written.
struct CsvDialect {
  char separator = ',';
  char decimal = '.';  ///< in numbers that are no whole ones
  bool mark = false;   ///< a byte-order mark first, by which spreadsheets know UTF-8
};

/// What a spreadsheet of this computer's locale (LC_ALL, LC_NUMERIC or LANG) reads at a double click: with a
/// byte-order mark, and where the decimal mark is a comma with semicolons. base::Error: that locale is not
/// installed.
CsvDialect excel_dialect();

/// What is exported, and for whom.
struct ExportSource {
  std::filesystem::path database;
  const ExportKind& kind;
  std::set<std::string> people;  ///< who stands in the export (session.person)
  Readers readers;
  CsvDialect dialect = {};
};

/// A folder beside the target that is gone unless put in place, so that the target never holds a part. It is
/// registered in the database before it is made.
class ExportDraft {
 public:
  /// base::Error, with nothing made, unless the target is absent, an empty folder or an earlier export of
  /// that kind as it was written, and when the database cannot be written (RegisteredExport). The error names
  /// the file that was added or changed.
  ExportDraft(const ExportSource& source, const std::filesystem::path& target);
  ~ExportDraft();
  ExportDraft(const ExportDraft&) = delete;
  ExportDraft& operator=(const ExportDraft&) = delete;

  /// Where the export goes, as an absolute path.
  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }
  Readers readers() const { return readers_; }
  const CsvDialect& dialect() const { return dialect_; }
  /// Adds the list of files (own_exports.hpp) and makes the draft the target; an earlier export there goes.
  /// It is on the disk then. base::Error, and the target is gone, when one of its people withdrew meanwhile.
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

/// A file of a draft, with the folders above it; an error unless every byte of it came to the disk, and where
/// the name leads out of the draft or is none that every computer takes (base::check_file_name).
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

/// A whole file of a draft.
void write_file(const ExportDraft& draft, const std::string& name, const std::string& text);

/// Text with an apostrophe before it where a spreadsheet would take it for a formula: where it begins with
/// = + - @ (also in full width), a tab or a line end, or with apostrophes and one of these. Whoever reads it
/// takes one apostrophe away where apostrophes and one of these begin a field, and has what it was.
std::string formula_guarded(const std::string& text);
/// The same in words, for the descriptions of an export.
extern const char* const formula_guard_meaning;
/// A text as a field of CSV: formula_guarded(), quoted where RFC 4180 asks for it or where it was guarded.
std::string csv_field(const std::string& text, const CsvDialect& dialect = {});
/// The shortest text that reads back as the same number.
std::string number_text(double value);
/// A number's text with the dialect's decimal mark.
std::string csv_number(std::string text, const CsvDialect& dialect);
/// A value of a row: a text as csv_field(), a number as csv_number(), empty for NULL.
std::string csv_value(const sqlite::Statement& row, int column, const CsvDialect& dialect = {});
/// A line of fields that are ready.
std::string csv_line(const std::vector<std::string>& fields, const CsvDialect& dialect);
/// The byte-order mark, where there is one, and the line of names.
std::string csv_head(const std::vector<std::string>& names, const CsvDialect& dialect);
/// The rows that `sql` selects, under a line with the names of its columns; returns their number.
std::int64_t write_csv(sqlite::Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name);

}  // namespace study
