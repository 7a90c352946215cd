#include "libstudy/store/export_register.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <vector>

#include "libstudy/store/beside.hpp"
#include "libstudy/store/database.hpp"
#include "libstudy/store/writer_lock.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

constexpr std::size_t largest_file_bytes = std::size_t{1} << 32;

/// Name of this computer; empty where it has none.
std::string this_host() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

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
  insert.bind(0, kind).bind(1, path.string()).bind(2, this_host()).bind(3, base::utc_now()).step();
  const std::int64_t id = insert.integer(0);
  insert.reset();
  Statement member(database, "INSERT OR IGNORE INTO export_person VALUES (?,?)");
  for (const std::string& person : people) member.bind(0, id).bind(1, person).run();
  return id;
}

void strike_out(Connection& database, std::int64_t id) {
  Statement(database, "DELETE FROM export_person WHERE export_id = ?").bind(0, id).run();
  Statement(database, "DELETE FROM export WHERE export_id = ?").bind(0, id).run();
}

bool is_draft_name(const std::string& name, const std::string& target) {
  if (!name.starts_with(target + ".tmp")) return false;
  std::string rest = name.substr(target.size() + 4);
  if (rest.ends_with(".old")) rest.resize(rest.size() - 4);
  return !rest.empty() && rest.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// What a kill left of it, and what another deletion had begun with.
void remove_drafts(const fs::path& path) {
  std::error_code none;
  std::vector<fs::path> drafts;
  for (const auto& entry : fs::directory_iterator(path.parent_path(), none))
    if (is_draft_name(entry.path().filename().string(), path.filename().string()))
      drafts.push_back(entry.path());
  for (const fs::path& draft : drafts) fs::remove_all(draft);
}

/// Aside first: the place never holds a part of it, which nobody would recognise.
void remove_whole(const fs::path& path) {
  const fs::path aside = draft_of(path);
  fs::rename(path, aside);
  fs::remove_all(aside);
}

std::string sha256_of(const fs::path& path) {
  const auto kind = fs::symlink_status(path).type();
  if (kind == fs::file_type::directory) return sha256_of_names(path);
  return kind == fs::file_type::regular ? base::sha256_hex(base::read_file(path, largest_file_bytes)) : "";
}

/// A row of `export` that holds somebody who withdrew.
struct Leftover {
  std::int64_t id = 0;
  std::string kind, host, sha256;
  fs::path path;
  bool tackled = false;
};

std::vector<Leftover> leftovers(Connection& database) {
  Statement row(database,
                "SELECT export_id, kind, host, sha256, path, tackled FROM export e WHERE EXISTS "
                "(SELECT 1 FROM export_person JOIN tombstone USING (person) WHERE export_id = e.export_id) "
                "ORDER BY host, path");
  std::vector<Leftover> all;
  while (row.step())
    all.push_back({row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4), row.integer(5) != 0});
  return all;
}

void mark_tackled(Connection& database, const Leftover& one) {
  Statement(database, "UPDATE export SET tackled = 1 WHERE export_id = ?").bind(0, one.id).run();
}

/// Why it is not deleted; empty: it is gone.
std::string remove_leftover(Connection& database, const Leftover& one) {
  if (one.host != this_host() && !one.host.empty()) {
    return "is on the computer '" + one.host +
           "'\n  mend: delete it there, with what was copied from it, or repeat the withdrawal there";
  }
  remove_drafts(one.path);
  if (!fs::exists(fs::symlink_status(one.path))) {
    const bool was_there = one.host.empty() || !one.sha256.empty();
    if (one.tackled || !was_there) return "";
    return "is no longer there\n  mend: where it was moved or copied to, delete it";
  }
  if (one.sha256.empty() && !one.host.empty()) return "";  // it was never put in place
  if (one.sha256.empty() || sha256_of(one.path) != one.sha256)
    return "is not as it was written: it was changed, or files were added\n  mend: delete it by hand";
  mark_tackled(database, one);
  remove_whole(one.path);
  return "";
}

}  // namespace

std::set<std::string> everybody(Connection& database) {
  std::set<std::string> people;
  for (Statement row(database, "SELECT DISTINCT person FROM session"); row.step();)
    people.insert(row.text(0));
  return people;
}

RegisteredExport::RegisteredExport(const fs::path& database, const std::string& kind, const fs::path& path,
                                   const std::set<std::string>& people)
    : database_(database), path_(without_links(path)), kind_(kind), people_(people) {
  const auto file = open_register(database_);
  Transaction transaction(*file);
  enter(*file, kind_, path_, people_);
  Statement(*file, "INSERT INTO event (utc, kind, detail) VALUES (?, 'export', ?)")
      .bind(0, base::utc_now())
      .bind(1, path_.string())
      .run();
  transaction.commit();
}

RegisteredExport::~RegisteredExport() {
  if (named_) return;
  try {
    const auto file = open_register(database_);
    Transaction transaction(*file);
    Statement row(*file, "SELECT export_id FROM export WHERE host = ? AND path = ? AND sha256 = ''");
    if (row.bind(0, this_host()).bind(1, path_.string()).step()) {
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
  Statement(*file, "UPDATE export SET sha256 = ? WHERE export_id = ?").bind(0, sha256).bind(1, id).run();
  transaction.commit();
  named_ = true;
}

// A withdrawal either sees the export in its place or is seen here.
void RegisteredExport::is_in_place() {
  const auto file = open_register(database_);
  Transaction transaction(*file);
  Statement gone(*file, "SELECT participant FROM tombstone WHERE person = ?");
  for (const std::string& person : people_) {
    if (!gone.bind(0, person).step()) continue;
    fs::remove_all(path_);
    throw base::Error(path_.string(), "was deleted again: " + gone.text(0) + " withdrew while it was written",
                      "export again");
  }
  Statement member(
      *file, "SELECT person FROM export_person JOIN export USING (export_id) WHERE host = ? AND path = ?");
  std::vector<std::string> former;
  for (member.bind(0, this_host()).bind(1, path_.string()); member.step();)
    if (!people_.contains(member.text(0))) former.push_back(member.text(0));
  Statement strike(*file,
                   "DELETE FROM export_person WHERE person = ? AND export_id = "
                   "(SELECT export_id FROM export WHERE host = ? AND path = ?)");
  for (const std::string& person : former)
    strike.bind(0, person).bind(1, this_host()).bind(2, path_.string()).run();
  transaction.commit();
}

RegisteredFiles::RegisteredFiles(const fs::path& database)
    : database_(database), people_(everybody(*open_database(database, Open::Read, read_schema_steps()))) {}

void RegisteredFiles::write(const std::string& kind, const fs::path& path, const std::string& bytes) const {
  std::set<std::string> people = everybody(*open_register(database_));
  people.insert(people_.begin(), people_.end());
  RegisteredExport record(database_, kind, path, people);
  record.will_be(base::sha256_hex(bytes));
  base::write_file_atomically(path, bytes);
  record.is_in_place();
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

bool holds_withdrawn(Connection& database) {
  const auto all = leftovers(database);
  return std::any_of(all.begin(), all.end(),
                     [](const Leftover& one) { return one.host.empty() || one.host == this_host(); });
}

void delete_exports_of_withdrawn(Connection& database, CleanUp& done) {
  for (const Leftover& one : leftovers(database)) {
    std::string problem;
    try {
      const bool there = fs::exists(one.path);
      problem = remove_leftover(database, one);
      if (problem.empty() && there) done.cleaned.push_back(one.path);
    } catch (const std::exception& error) {
      problem = std::string("cannot be deleted: ") + error.what() + "\n  mend: delete it by hand";
    }
    Transaction transaction(database);
    if (problem.empty()) {
      strike_out(database, one.id);
      ChorePlan(database).rewrite();
    } else {
      mark_tackled(database, one);
      done.left.push_back("export " + one.path.string() + " (" + one.kind + ") " + problem);
    }
    transaction.commit();
  }
}

}  // namespace study
