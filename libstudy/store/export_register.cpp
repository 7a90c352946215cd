#include "libstudy/store/export_register.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "libstudy/store/open_study.hpp"
#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/new_file.hpp"

namespace study {

namespace fs = std::filesystem;
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

fs::path place_of_study(const fs::path& database) {
  return service_of(database) ? database : fs::weakly_canonical(real_file(database));
}

void check_writable(const fs::path& file) {
  if (::access(file.c_str(), W_OK) == 0 && ::access(fs::absolute(file).parent_path().c_str(), W_OK) == 0)
    return;
  throw base::Error(
      file.string(),
      "you may not write to it or to its folder, and each export is registered in it for withdrawals",
      "ask somebody to export who may write to the database and its folder");
}

/// Opens the database for a short write to its register; upgrades an older schema first. Needs a WriterLock
/// only for an upgrade, so it works while a session is running.
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

/// Adds an export and its people to the register, or people to an export with the same path; returns its id.
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

/// Removes from this installation's register the earlier exports that the export `by` replaced at its path.
/// Keeps an entry whose draft still exists, so that a withdrawal can find and delete the draft.
void forget_replaced(const OwnExport& by) {
  try {
    std::set<std::string> replaced;
    for (const OwnExport& other : own_exports_at(by.path)) {
      std::error_code ignored;
      if (other.id != by.id && (other.draft.empty() || !fs::exists(other.draft, ignored)))
        replaced.insert(other.id);
    }
    forget_own_exports(replaced);
  } catch (const base::Error&) {
    // An entry of an export that no longer exists does no harm.
  }
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

void label_everybody(const fs::path& database) {
  if (service_of(database)) return;  // read_central_study() gave the labels
  const auto file = open_register(database);
  Transaction transaction(*file);
  give_labels(*file);
  transaction.commit();
}

std::unique_ptr<Connection> open_to_export(const StudyFile& study) {
  auto database = open_study(study).database;
  if (service_of(study.path)) return database;
  if (database->text("PRAGMA journal_mode") != "delete") return database;
  database.reset();
  const fs::path file = real_file(study.path);
  check_writable(file);
  {
    const WriterLock lock(file);
    open_database(file, Open::Write, read_schema_steps());
  }
  return open_study(study).database;
}

RegisteredExport::RegisteredExport(const fs::path& database, const std::string& kind, const fs::path& path,
                                   const std::set<std::string>& people, const fs::path& draft)
    : database_(database),
      own_{.id = new_export_id(),
           .host = this_host(),
           .kind = kind,
           .database = place_of_study(database),
           .path = without_links(path),
           .draft = {},
           .sha256 = {},
           .people = people} {
  own_.draft = draft.empty() ? fs::path(own_.path.string() + ".tmp" + own_.id) : without_links(draft);
  if (service_of(database_)) {
    keep_own();
    return;
  }
  const JournalContent journal = read_journal(journal_beside(database_));
  const std::int64_t journal_event = std::max(last_event(journal.kept), last_event(journal.pending));
  const auto file = open_register(database_);
  keep_own();
  Transaction transaction(*file);
  enter(*file, own_.kind, own_.path, own_.people);
  // The answer journal beside the database may contain events that the database lacks. The new event_id must
  // exceed the ids of those events, so that no id is used twice.
  Statement(*file,
            "INSERT INTO event (event_id, utc, kind, detail) SELECT max(coalesce(max(event_id), 0), ?) + 1, "
            "?, 'export', ? FROM event")
      .bind_all(journal_event, base::utc_now(), own_.path.string())
      .run();
  transaction.commit();
}

/// Enters the export in this installation's register. If that fails, the export is made nevertheless: a
/// withdrawal then lists the export instead of deleting it.
void RegisteredExport::keep_own() {
  try {
    keep_own_export(own_);
  } catch (const base::Error&) {
  }
}

RegisteredExport::~RegisteredExport() {
  if (named_ || service_of(database_)) return;
  try {
    const auto file = open_register(database_);
    Transaction transaction(*file);
    Statement row(*file, "SELECT export_id FROM export WHERE host = ? AND path = ? AND sha256 = ''");
    if (row.bind_all(this_host(), own_.path.string()).step()) {
      const std::int64_t id = row.integer(0);
      row.reset();
      export_rows::strike_out(*file, id);
    }
    transaction.commit();
    std::error_code ignored;
    if (!fs::exists(own_.draft, ignored)) forget_own_exports({own_.id});
  } catch (const std::exception&) {
    // The row stays in the register; a row of an export that does not exist does no harm.
  }
}

void RegisteredExport::will_be(const std::string& sha256) {
  own_.sha256 = sha256;
  keep_own();
  if (service_of(database_)) {
    named_ = true;
    return;
  }
  const auto file = open_register(database_);
  Transaction transaction(*file);
  const std::int64_t id = enter(*file, own_.kind, own_.path, own_.people);
  Statement(*file, "UPDATE export SET sha256 = ? WHERE export_id = ?").bind_all(sha256, id).run();
  transaction.commit();
  named_ = true;
}

// The transaction checks after the rename for people who withdrew (tombstones). So either the withdrawal
// finds the export at its path, or this function finds the withdrawal.
void RegisteredExport::is_in_place() {
  base::sync_folder_of(own_.path);
  if (service_of(database_)) {
    forget_replaced(own_);
    return;
  }
  const auto file = open_register(database_);
  Transaction transaction(*file);
  Statement gone(*file, "SELECT participant FROM tombstone WHERE person = ?");
  for (const std::string& person : own_.people) {
    if (!gone.bind_all(person).step()) continue;
    base::remove_durably(own_.path);
    throw base::Error(own_.path.string(),
                      "was deleted again: " + gone.text(0) + " withdrew while it was written",
                      "export again");
  }
  Statement member(
      *file, "SELECT person FROM export_person JOIN export USING (export_id) WHERE host = ? AND path = ?");
  std::vector<std::string> former;
  for (member.bind_all(this_host(), own_.path.string()); member.step();)
    if (!own_.people.contains(member.text(0))) former.push_back(member.text(0));
  Statement strike(*file,
                   "DELETE FROM export_person WHERE person = ? AND export_id = "
                   "(SELECT export_id FROM export WHERE host = ? AND path = ?)");
  for (const std::string& person : former) strike.bind_all(person, this_host(), own_.path.string()).run();
  transaction.commit();
  forget_replaced(own_);
}

RegisteredFiles::RegisteredFiles(const StudyFile& study)
    : database_(study.path), people_(everybody(*open_study(study).database)) {}

void RegisteredFiles::write(const std::string& kind, const fs::path& path, const std::string& bytes) const {
  std::set<std::string> people = people_;
  if (!service_of(database_)) people.merge(everybody(*open_register(database_)));
  base::NewFile file(path, base::Readers::Owner);
  RegisteredExport record(database_, kind, path, people, file.draft());
  file.write(bytes);
  record.will_be(base::sha256_hex(bytes));
  file.put_in_place();
  record.is_in_place();
}

// A kill between mkdir() and the registration leaves an unregistered folder, which is empty and so harmless.
void RegisteredFiles::make_folder(const fs::path& folder) const {
  const fs::path path = without_links(folder);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return;
  make_folder(path.parent_path());
  if (::mkdir(path.c_str(), 0700) != 0)
    throw base::Error(path.string(), std::string("cannot be made a folder: ") + std::strerror(errno),
                      "choose another folder");
  base::sync_folder_of(path);
  try {
    keep_own_export({.id = new_export_id(),
                     .host = this_host(),
                     .kind = export_rows::folder_kind,
                     .database = place_of_study(database_),
                     .path = path,
                     .draft = {},
                     .sha256 = {},
                     .people = {}});
  } catch (const base::Error&) {  // a withdrawal then does not remove the empty folder
  }
  if (service_of(database_)) return;
  const auto file = open_register(database_);
  Statement(*file,
            "INSERT OR IGNORE INTO export (kind, path, host, sha256, utc, tackled) VALUES (?,?,?,'',?,0)")
      .bind_all(export_rows::folder_kind, path.string(), this_host(), base::utc_now())
      .run();
}

}  // namespace study
