#pragma once
/// Folders of exports: made whole beside their place, then put there by one rename.

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "libstudy/store/export_register.hpp"
#include "libstudy/store/sqlite.hpp"

namespace study {

/// A file of an export.
struct ExportedFile {
  std::string name;
  std::int64_t rows = 0;
};

/// What is exported.
struct ExportSource {
  std::filesystem::path database;
  const char* kind;              ///< csv, bids, psych-ds
  std::set<std::string> people;  ///< who stands in the export (session.person)
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
  /// Makes the draft the target; an earlier export there goes. base::Error, and the target is gone, when one
  /// of its people withdrew meanwhile.
  void put_in_place();

 private:
  void replace_target();
  bool replace_in_two_steps();
  [[noreturn]] void fail(const std::string& problem);

  std::filesystem::path target_, path_;
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

/// Quoted where RFC 4180 asks for it.
std::string csv_field(const std::string& text);
/// The shortest text that reads back as the same number.
std::string number_text(double value);
/// A value of a row; empty for NULL.
std::string csv_value(const sqlite::Statement& row, int column);
/// The rows that `sql` selects, under a line with the names of its columns; returns their number.
std::int64_t write_csv(sqlite::Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name);

}  // namespace study
