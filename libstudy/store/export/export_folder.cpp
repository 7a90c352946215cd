#include "libstudy/store/export/export_folder.hpp"

#include <fcntl.h>
#include <langinfo.h>
#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <sstream>

#include "libstudy/store/own_exports.hpp"
#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"
#include "stats/base/outgoing.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr std::size_t most_list_bytes = 1 << 28, sha256_digits = 64;

fs::path whole_path(const fs::path& folder) {
  fs::path target = fs::absolute(folder).lexically_normal();
  return target.has_filename() ? target : target.parent_path();
}

/// SHA-256 by file name, from the list of files in an export folder; empty if the folder has no list.
std::map<std::string, std::string> listed_files(const fs::path& folder, const ExportKind& kind) {
  const fs::path marker = folder / marker_of(kind.name);
  std::map<std::string, std::string> files;
  std::error_code ignored;
  if (fs::symlink_status(marker, ignored).type() != fs::file_type::regular) return files;
  std::istringstream lines(base::read_file(marker, most_list_bytes));
  for (std::string line; std::getline(lines, line);)
    if (line.size() > sha256_digits + 2 && line[0] != '#')
      files[line.substr(sha256_digits + 2)] = line.substr(0, sha256_digits);
  files[marker_of(kind.name)] = base::sha256_of_file(marker);
  return files;
}

/// Why a folder is not an unchanged earlier export, as the end of an error text; empty if it is an unchanged
/// export.
std::string strange_file(const fs::path& folder, const ExportKind& kind) {
  const auto listed = listed_files(folder, kind);
  std::set<std::string> added, changed;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (entry.is_directory() && !entry.is_symlink()) continue;
    const bool is_file = entry.is_regular_file() && !entry.is_symlink();
    if (!is_file || !(listed.empty() ? kind.is_name(name) : listed.contains(name)))
      added.insert(name);
    else if (!listed.empty() && base::sha256_of_file(entry.path()) != listed.at(name))
      changed.insert(name);
  }
  if (!added.empty()) return ": '" + base::shortened(*added.begin()) + "' was added";
  if (!changed.empty())
    return " as it was written: '" + base::shortened(*changed.begin()) + "' was changed since";
  return listed.empty() && !kind.is_export(folder) ? ": it was not written by vip-study" : "";
}

void check_target(const fs::path& folder, const ExportKind& kind) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(folder, ignored))) return;
  std::string strange = ": it is not a folder";
  if (!fs::is_symlink(folder) && fs::is_directory(folder, ignored))
    strange = fs::is_empty(folder, ignored) ? "" : strange_file(folder, kind);
  if (strange.empty()) return;
  throw base::Error(folder.string(), "exists and is not an earlier export" + strange,
                    "name another folder, or move this one away");
}

}  // namespace

ExportDraft::ExportDraft(const ExportSource& source, const fs::path& target)
    : target_(whole_path(target)), kind_(source.kind), readers_(source.readers), dialect_(source.dialect) {
  check_target(target_, kind_);
  record_.emplace(source.database, kind_.name, target_, source.people);
  path_ = record_->draft();
  base::make_folder_of(target_);
  if (::mkdir(path_.c_str(), readers_ == Readers::Owner ? 0700 : 0777) != 0) fail("cannot be made");
}

ExportDraft::~ExportDraft() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void ExportDraft::put_in_place() {
  const std::string list = list_of_files(path_, kind_.name, record_->id());
  write_file(*this, marker_of(kind_.name), list);
  base::sync_folders(path_);
  record_->will_be(base::sha256_hex(list));
  replace_target();
  // If there was an earlier export, it now has the draft's path. Deletes it durably, because it may contain
  // people who are not in the new export.
  base::remove_durably(path_);
  record_->is_in_place();
}

// Exchanges the paths of draft and target, so that an earlier export gets the draft's path.
void ExportDraft::replace_target() {
  std::error_code ignored;
  const unsigned flags = fs::exists(target_, ignored) ? RENAME_EXCHANGE : RENAME_NOREPLACE;
  if (base::rename_durably(path_, target_, flags)) return;
  // Some file systems, such as network file systems, cannot exchange two paths (EINVAL): rename the earlier
  // export first, then the draft.
  if (errno != EINVAL || !replace_in_two_steps()) fail("cannot be put in place");
}

bool ExportDraft::replace_in_two_steps() {
  std::error_code ignored;
  const fs::path aside = path_.string() + ".old";
  if (fs::exists(target_, ignored) && !base::rename_durably(target_, aside)) return false;
  if (!base::rename_durably(path_, target_)) {
    const int problem = errno;
    base::rename_durably(aside, target_);
    errno = problem;
    return false;
  }
  base::remove_durably(aside);
  return true;
}

void ExportDraft::fail(const std::string& problem) {
  throw base::Error(target_.string(), problem + ": " + std::strerror(errno),
                    "free space, or name a folder where you may write");
}

ExportFile::ExportFile(const ExportDraft& draft, const std::string& name)
    : shown_((draft.target() / name).string()) {
  base::check_file_name(name, draft.target().string());
  const fs::path path = draft.path() / name;
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  const mode_t rights = draft.readers() == Readers::Owner ? 0600 : 0666;
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, rights);
  file_ = fd < 0 ? nullptr : ::fdopen(fd, "wb");
  if (!file_) fail();
}

ExportFile::~ExportFile() {
  if (file_) std::fclose(file_);
}

void ExportFile::write(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void ExportFile::finish() {
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail();
}

void ExportFile::fail() const {
  throw base::Error(shown_, std::string("cannot be written: ") + std::strerror(errno),
                    "free space, or name a folder where you may write");
}

const char* const formula_guard_meaning =
    "text that begins with = + - @ (also in full width), a tab or a line end, or with apostrophes and one of "
    "these, has one more apostrophe before it, so that no spreadsheet takes it for a formula; take one "
    "apostrophe away where apostrophes and one of these begin a field";

void write_file(const ExportDraft& draft, const std::string& name, const std::string& text) {
  ExportFile file(draft, name);
  file.write(text);
  file.finish();
}

std::string formula_guarded(const std::string& text) {
  const std::size_t first = std::min(text.find_first_not_of('\''), text.size());
  const std::string_view rest = std::string_view(text).substr(first);
  for (const char* sign : {"=", "+", "-", "@", "\t", "\r", "\n", "\uFF1D", "\uFF0B", "\uFF0D", "\uFF20"}) {
    if (rest.starts_with(sign)) return "'" + text;
  }
  return text;
}

std::string csv_field(const std::string& words, const CsvDialect& dialect) {
  const std::string text = formula_guarded(words), special = std::string("\"\r\n") + dialect.separator;
  if (text.size() == words.size() && text.find_first_of(special) == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_number(std::string text, const CsvDialect& dialect) {
  std::replace(text.begin(), text.end(), '.', dialect.decimal);
  return text;
}

std::string csv_line(const std::vector<std::string>& fields, const CsvDialect& dialect) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i)
    line += (i > 0 ? std::string(1, dialect.separator) : "") + fields[i];
  return line + "\r\n";
}

std::string csv_head(const std::vector<std::string>& names, const CsvDialect& dialect) {
  return (dialect.mark ? "\xEF\xBB\xBF" : "") + csv_line(names, dialect);
}

CsvDialect excel_dialect() {
  const locale_t here = ::newlocale(LC_NUMERIC_MASK, "", nullptr);
  if (!here) {
    throw base::Error("--excel", "the locale that LC_ALL, LC_NUMERIC or LANG names is not installed",
                      "install it, or name another: LC_ALL=C.UTF-8 writes commas and decimal points");
  }
  const bool comma = std::string(::nl_langinfo_l(RADIXCHAR, here)) == ",";
  ::freelocale(here);
  return comma ? CsvDialect{';', ',', true} : CsvDialect{',', '.', true};
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string csv_value(const Statement& row, int column, const CsvDialect& dialect) {
  if (row.is_null(column)) return {};
  if (row.is_text(column)) return csv_field(row.text(column), dialect);
  return row.is_real(column) ? csv_number(number_text(row.real(column)), dialect) : row.text(column);
}

std::int64_t write_csv(Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name) {
  ExportFile file(draft, name);
  Statement row(database, sql);
  std::vector<std::string> fields;
  for (int i = 0; i < row.columns(); ++i) fields.push_back(row.column_name(i));
  file.write(csv_head(fields, draft.dialect()));
  std::int64_t rows = 0;
  for (; row.step(); ++rows) {
    for (int i = 0; i < row.columns(); ++i)
      fields[static_cast<std::size_t>(i)] = csv_value(row, i, draft.dialect());
    file.write(csv_line(fields, draft.dialect()));
  }
  file.finish();
  return rows;
}

}  // namespace study
