#include "libstudy/store/export_register.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "libstudy/store/beside.hpp"
#include "libstudy/store/database.hpp"
#include "libstudy/store/export_rows.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/settling.hpp"
#include "libstudy/store/writer_lock.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
using export_rows::strike_out;
using export_rows::this_host;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

fs::path without_links(const fs::path& path) {
  fs::path target = fs::absolute(path);
  if (!target.has_filename()) target = target.parent_path();
  return fs::weakly_canonical(target.parent_path()) / target.filename();
}

void check_writable(const fs::path& file) {
  if (::access(file.c_str(), W_OK) == 0 && ::access(fs::absolute(file).parent_path().c_str(), W_OK) == 0)
    return;
  throw base::Error(file.string(),
                    "cannot be written by you: an export is registered in it, so that a withdrawal finds it",
                    "let somebody export who may write the database and its folder");
}

/// The database for a short write beside a session that may be running; an older one is upgraded first.
std::unique_ptr<Connection> open_register(const fs::path& database) {
  const fs::path file = real_file(database);
  check_writable(file);
  const SchemaSteps steps = read_schema_steps();
  auto connection = std::make_unique<Connection>(file, Open::Write);
  connection->mark_commits();
  if (connection->integer("PRAGMA user_version") != static_cast<std::int64_t>(steps.size())) {
    connection.reset();
    const WriterLock lock(file);
    connection = open_database(file, Open::Write, steps);
  }
  connection->execute("PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL; PRAGMA secure_delete = ON");
  return connection;
}

/// Adds an export, or people to it; returns its row.
std::int64_t enter(Connection& database, const std::string& kind, const fs::path& path,
                   const std::set<std::string>& people) {
  Statement insert(
      database,
      "INSERT INTO export (kind, path, host, sha256, utc, tackled) VALUES (?,?,?,'',?,0) "
      "ON CONFLICT (host, path) DO UPDATE SET kind = excluded.kind, utc = excluded.utc, tackled = 0 "
      "RETURNING export_id");
  insert.bind_all(kind, path.string(), this_host(), base::utc_now()).step();
  const std::int64_t id = insert.integer(0);
  insert.reset();
  Statement member(database, "INSERT OR IGNORE INTO export_person VALUES (?,?)");
  for (const std::string& person : people) member.bind_all(id, person).run();
  return id;
}

}  // namespace

std::string export_rows::this_host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

void export_rows::strike_out(Connection& database, std::int64_t id) {
  Statement(database, "DELETE FROM export_person WHERE export_id = ?").bind_all(id).run();
  Statement(database, "DELETE FROM export WHERE export_id = ?").bind_all(id).run();
}

std::set<std::string> everybody(Connection& database) {
  std::set<std::string> people;
  for (Statement row(database, "SELECT DISTINCT person FROM session"); row.step();)
    people.insert(row.text(0));
  return people;
}

void finish_cut_commit(const StudyFile& study) {
  try {
    const fs::path file = real_file(study.path);
    if (study.incomplete || read_journal(journal_beside(file)).pending.empty()) return;
    const WriterLock lock(file);
    settle_before_writing(*open_database(file, Open::Write, read_schema_steps()));
  } catch (const base::Error&) {
    // A session is at work, or who opens the study next is refused as well.
  }
}

RegisteredExport::RegisteredExport(const fs::path& database, const std::string& kind, const fs::path& path,
                                   const std::set<std::string>& people)
    : database_(database), path_(without_links(path)), kind_(kind), people_(people) {
  const auto file = open_register(database_);
  Transaction transaction(*file);
  enter(*file, kind_, path_, people_);
  Statement(*file, "INSERT INTO event (utc, kind, detail) VALUES (?, 'export', ?)")
      .bind_all(base::utc_now(), path_.string())
      .run();
  transaction.commit();
}

RegisteredExport::~RegisteredExport() {
  if (named_) return;
  try {
    const auto file = open_register(database_);
    Transaction transaction(*file);
    Statement row(*file, "SELECT export_id FROM export WHERE host = ? AND path = ? AND sha256 = ''");
    if (row.bind_all(this_host(), path_.string()).step()) {
      const std::int64_t id = row.integer(0);
      row.reset();
      strike_out(*file, id);
    }
    transaction.commit();
  } catch (const std::exception&) {
    // The row of an export that is not there does no harm.
  }
}

void RegisteredExport::will_be(const std::string& sha256) {
  const auto file = open_register(database_);
  Transaction transaction(*file);
  const std::int64_t id = enter(*file, kind_, path_, people_);
  Statement(*file, "UPDATE export SET sha256 = ? WHERE export_id = ?").bind_all(sha256, id).run();
  transaction.commit();
  named_ = true;
}

// A withdrawal either sees the export in its place or is seen here.
void RegisteredExport::is_in_place() {
  const auto file = open_register(database_);
  Transaction transaction(*file);
  Statement gone(*file, "SELECT participant FROM tombstone WHERE person = ?");
  for (const std::string& person : people_) {
    if (!gone.bind_all(person).step()) continue;
    fs::remove_all(path_);
    throw base::Error(path_.string(), "was deleted again: " + gone.text(0) + " withdrew while it was written",
                      "export again");
  }
  Statement member(
      *file, "SELECT person FROM export_person JOIN export USING (export_id) WHERE host = ? AND path = ?");
  std::vector<std::string> former;
  for (member.bind_all(this_host(), path_.string()); member.step();)
    if (!people_.contains(member.text(0))) former.push_back(member.text(0));
  Statement strike(*file,
                   "DELETE FROM export_person WHERE person = ? AND export_id = "
                   "(SELECT export_id FROM export WHERE host = ? AND path = ?)");
  for (const std::string& person : former) strike.bind_all(person, this_host(), path_.string()).run();
  transaction.commit();
}

RegisteredFiles::RegisteredFiles(const StudyFile& study) : database_(study.path) {
  finish_cut_commit(study);
  people_ = everybody(*open_study(study).database);
}

void RegisteredFiles::write(const std::string& kind, const fs::path& path, const std::string& bytes) const {
  std::set<std::string> people = everybody(*open_register(database_));
  people.insert(people_.begin(), people_.end());
  RegisteredExport record(database_, kind, path, people);
  base::NewFile file(path, base::Readers::Owner);
  file.write(bytes);
  record.will_be(base::sha256_hex(bytes));
  file.put_in_place();
  record.is_in_place();
}

// A kill between the two leaves an empty folder, which holds nobody.
void RegisteredFiles::make_folder(const fs::path& folder) const {
  const fs::path path = without_links(folder);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return;
  make_folder(path.parent_path());
  if (::mkdir(path.c_str(), 0700) != 0)
    throw base::Error(path.string(), std::string("cannot be made a folder: ") + std::strerror(errno),
                      "choose another folder");
  const auto file = open_register(database_);
  Statement(*file,
            "INSERT OR IGNORE INTO export (kind, path, host, sha256, utc, tackled) VALUES (?,?,?,'',?,0)")
      .bind_all(export_rows::folder_kind, path.string(), this_host(), base::utc_now())
      .run();
}

std::string sha256_of_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_directory() || entry.is_symlink())
      names.insert(entry.path().lexically_relative(folder).string());
  std::string text;
  for (const std::string& name : names) text += name + '\n';
  return base::sha256_hex(text);
}

fs::path draft_of(const fs::path& path) { return path.string() + ".tmp" + std::to_string(::getpid()); }

}  // namespace study
