#include "libstudy/store/personal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/schema.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

// Uses a rollback journal instead of a write-ahead log: SQLite deletes the journal at each commit, so no file
// beside the personal file contains deleted data.
constexpr const char* opening =
    "PRAGMA journal_mode = DELETE; PRAGMA secure_delete = ON; PRAGMA synchronous = EXTRA";
constexpr std::array<const char*, 2> tables{
    "personal (participant TEXT NOT NULL, question TEXT NOT NULL, wording TEXT NOT NULL, "
    "answer TEXT NOT NULL, PRIMARY KEY (participant, question)) STRICT",
    "renaming (batch TEXT PRIMARY KEY) STRICT"};

/// Makes the file if it is missing, and sets its mode to 0600 before any data are written.
void make_private(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  const bool done = fd >= 0 && ::fchmod(fd, 0600) == 0;
  const int problem = errno;
  if (fd >= 0) ::close(fd);
  if (!done) {
    throw base::Error(path.string(), std::string("cannot be kept private: ") + std::strerror(problem),
                      "use a folder and a file that you own");
  }
}

[[noreturn]] void refuse_personal(const sqlite::Connection& file, const std::string& problem) {
  throw base::Error(file.path().string(), problem,
                    "restore a backup of it, or move it elsewhere: it holds personal answers only");
}

/// base::Error if the file has other tables, columns or triggers than vip-study makes: these could preserve
/// data that vip-study reports as deleted.
void check_schema(sqlite::Connection& file) {
  file.distrust();
  {
    Statement foreign(
        file, "SELECT name FROM sqlite_schema WHERE sql NOT IN ('CREATE TABLE ' || ?, 'CREATE TABLE ' || ?)");
    if (foreign.bind_all(tables[0], tables[1]).step())
      refuse_personal(file, "holds '" + printable(foreign.text(0)) + "', which vip-study did not make");
  }
  file.recognise();
}

}  // namespace

std::vector<PersonalEntry> read_personal(const fs::path& database) {
  const fs::path path = PersonalFile::beside(database);
  if (!fs::exists(path)) return {};
  sqlite::Connection file(path, sqlite::Open::Read);
  std::vector<PersonalEntry> entries;
  if (file.integer("SELECT count(*) FROM sqlite_schema WHERE name = 'personal'") == 0) return entries;
  for (Statement row(file, "SELECT participant, question, wording, answer FROM personal ORDER BY 1, 2");
       row.step();)
    entries.push_back({row.text(0), row.text(1), row.text(2), row.text(3)});
  return entries;
}

PersonalFile::PersonalFile(const fs::path& database) {
  const fs::path path = beside(database);
  make_private(path);
  file_ = std::make_unique<sqlite::Connection>(path, sqlite::Open::Write);
  check_schema(*file_);
  file_->execute(opening);
  for (const char* table : tables) file_->execute(std::string("CREATE TABLE IF NOT EXISTS ") + table);
  if (const std::string found = file_->text("PRAGMA integrity_check(1)"); found != "ok")
    refuse_personal(*file_, "is damaged: " + found);
  file_->seal();
}

fs::path PersonalFile::beside(const fs::path& database) { return study::beside(database, ".personal"); }

void PersonalFile::keep(const std::vector<PersonalEntry>& entries) {
  Transaction transaction(*file_);
  Statement insert(*file_, "INSERT OR REPLACE INTO personal VALUES (?,?,?,?)");
  for (const PersonalEntry& entry : entries) {
    insert.bind_all(entry.participant, entry.question, entry.wording, entry.answer).run();
  }
  transaction.commit();
}

std::vector<PersonalEntry> PersonalFile::read(const std::string& participant) {
  Statement row(*file_, "SELECT * FROM personal WHERE participant = ? ORDER BY rowid");
  row.bind_all(participant);
  std::vector<PersonalEntry> entries;
  while (row.step()) entries.push_back({row.text(0), row.text(1), row.text(2), row.text(3)});
  return entries;
}

void PersonalFile::rename(const std::string& batch, const std::map<std::string, std::string>& codes) {
  Transaction transaction(*file_);
  Statement done(*file_, "INSERT OR IGNORE INTO renaming VALUES (?) RETURNING 1");
  const bool again = !done.bind_all(batch).step();
  done.reset();
  if (again) return;
  // Renames first to " <new code>", then removes the space: one person's new code may be another's old code.
  Statement aside(*file_, "UPDATE personal SET participant = ' ' || ? WHERE participant = ?");
  for (const auto& [before, now] : codes) aside.bind_all(now, before).run();
  file_->execute("UPDATE personal SET participant = substr(participant, 2) WHERE participant LIKE ' %'");
  transaction.commit();
}

void PersonalFile::forget(const std::string& participant) {
  Statement(*file_, "DELETE FROM personal WHERE participant = ?").bind_all(participant).run();
  file_->execute("VACUUM");
}

}  // namespace study
