#include "libstudy/store/export_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;

namespace {

fs::path whole_path(const fs::path& folder) {
  fs::path target = fs::absolute(folder).lexically_normal();
  return target.has_filename() ? target : target.parent_path();
}

void check_target(const fs::path& folder, const ExportDraft::IsExport& is_export) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(folder, ignored))) return;
  const bool ours = !fs::is_symlink(folder) && fs::is_directory(folder, ignored) &&
                    (fs::is_empty(folder, ignored) || is_export(folder));
  if (!ours) {
    throw base::Error(folder.string(), "exists and is not an earlier export",
                      "name another folder, or move what is there away");
  }
}

}  // namespace

ExportDraft::ExportDraft(const ExportSource& source, const fs::path& target, const IsExport& is_export)
    : target_(whole_path(target)), readers_(source.readers) {
  check_target(target_, is_export);
  record_.emplace(source.database, source.kind, target_, source.people);
  path_ = draft_of(target_);
  base::make_folder_of(target_);
  if (::mkdir(path_.c_str(), readers_ == Readers::Owner ? 0700 : 0777) != 0) fail("cannot be made");
}

ExportDraft::~ExportDraft() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void ExportDraft::put_in_place() {
  record_->will_be(sha256_of_names(path_));
  replace_target();
  // The earlier export: it may hold people who do not stand in this one.
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  record_->is_in_place();
}

// After the exchange the earlier export lies under the draft's name.
void ExportDraft::replace_target() {
  std::error_code ignored;
  const unsigned flags = fs::exists(target_, ignored) ? RENAME_EXCHANGE : RENAME_NOREPLACE;
  if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), flags) == 0) return;
  // Network file systems know the plain rename alone: the earlier export steps aside first.
  if (errno != EINVAL || !replace_in_two_steps()) fail("cannot be put in place");
}

bool ExportDraft::replace_in_two_steps() {
  std::error_code ignored;
  const fs::path aside = path_.string() + ".old";
  if (fs::exists(target_, ignored) && ::rename(target_.c_str(), aside.c_str()) != 0) return false;
  if (::rename(path_.c_str(), target_.c_str()) != 0) {
    const int problem = errno;
    ::rename(aside.c_str(), target_.c_str());
    errno = problem;
    return false;
  }
  fs::remove_all(aside, ignored);
  return true;
}

void ExportDraft::fail(const std::string& problem) {
  throw base::Error(target_.string(), problem + ": " + std::strerror(errno),
                    "free space, or name a folder where you may write");
}

ExportFile::ExportFile(const ExportDraft& draft, const std::string& name)
    : shown_((draft.target() / name).string()) {
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

std::string csv_field(const std::string& words) {
  const std::string text = formula_guarded(words);
  if (text.size() == words.size() && text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string csv_value(const Statement& row, int column) {
  if (row.is_null(column)) return {};
  if (row.is_text(column)) return csv_field(row.text(column));
  return row.is_real(column) ? number_text(row.real(column)) : row.text(column);
}

std::int64_t write_csv(Connection& database, const std::string& sql, const ExportDraft& draft,
                       const std::string& name) {
  ExportFile file(draft, name);
  Statement row(database, sql);
  std::string line;
  for (int i = 0; i < row.columns(); ++i) line += (i ? "," : "") + row.column_name(i);
  file.write(line + "\r\n");
  std::int64_t rows = 0;
  for (; row.step(); ++rows) {
    line.clear();
    for (int i = 0; i < row.columns(); ++i) {
      if (i) line += ',';
      line += csv_value(row, i);
    }
    file.write(line += "\r\n");
  }
  file.finish();
  return rows;
}

}  // namespace study
