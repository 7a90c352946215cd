#pragma once
/// Folders of exports: made whole beside their place, then put there by one rename.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
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

/// What is exported, and for whom.
struct ExportSource {
  std::filesystem::path database;
  const char* kind;              ///< csv, bids, psych-ds
  std::set<std::string> people;  ///< who stands in the export (session.person)
  Readers readers;
};

/// A folder beside the target that is gone unless put in place, so that the target never holds a part. It is
/// registered in the database before it is made.
class ExportDraft {
 public:
  using IsExport = std::function<bool(const std::filesystem::path&)>;
  /// base::Error, with nothing made, unless the target is absent, an empty folder or one that `is_export`,
  /// and when the database cannot be written (RegisteredExport).
  ExportDraft(const ExportSource& source, const std::filesystem::path& target, const IsExport& is_export);
  ~ExportDraft();
  ExportDraft(const ExportDraft&) = delete;
  ExportDraft& operator=(const ExportDraft&) = delete;

  /// Where the export goes, as an absolute path.
  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }
  Readers readers() const { return readers_; }
  /// Makes the draft the target; an earlier export there goes. base::Error, and the target is gone, when one
  /// of its people withdrew meanwhile.
  void put_in_place();

 private:
  void replace_target();
  bool replace_in_two_steps();
  [[noreturn]] void fail(const std::string& problem);

  std::filesystem::path target_, path_;
  Readers readers_;
  std::optional<RegisteredExport> record_;
};

/// A file of a draft, with the folders above it; an error unless every byte of it came to the disk.
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
std::string csv_field(const std::string& text);
/// The shortest text that reads back as the same number.
std::string number_text(double value);
/// A value of a row: a text as csv_field(), a number as it is, empty for NULL.
std::string csv_value(const sqlite::Statement& row, int column);
/// The rows that `sql` selects, under a line with the names of its columns; returns their number.
std::int64_t write_csv(sqlite::Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name);

}  // namespace study
