#include "libstudy/store/chores.hpp"

#include <algorithm>

#include "libstudy/store/answer_journal.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/file/backups.hpp"
#include "libstudy/store/personal.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Statement;
using sqlite::Transaction;

namespace {

/// One row of the table `chore`, or all rows of kind rename in a batch, which are done together.
struct Chore {
  std::vector<std::int64_t> rows;
  std::string kind, batch, person, participant;
  std::map<std::string, std::string> codes;  ///< new participant code by old code
};

std::vector<Chore> pending(Connection& database) {
  std::vector<Chore> chores;
  Statement row(database,
                "SELECT chore_id, kind, batch, person, participant, renamed FROM chore "
                "WHERE kind <> 'rewrite' ORDER BY chore_id");
  while (row.step()) {
    const std::string kind = row.text(1), batch = row.text(2);
    const bool same =
        kind == "rename" && !chores.empty() && chores.back().kind == kind && chores.back().batch == batch;
    if (!same)
      chores.push_back({.rows = {},
                        .kind = kind,
                        .batch = batch,
                        .person = row.text(3),
                        .participant = row.text(4),
                        .codes = {}});
    chores.back().rows.push_back(row.integer(0));
    if (kind == "rename") chores.back().codes[row.text(4)] = row.text(5);
  }
  return chores;
}

/// Deletes the rows of a finished chore, and plans a rewrite of the file, which still contains their bytes.
void strike_out(Connection& database, const Chore& chore) {
  Transaction transaction(database);
  for (const std::int64_t row : chore.rows)
    Statement(database, "DELETE FROM chore WHERE chore_id = ?").bind_all(row).run();
  ChorePlan(database).rewrite();
  transaction.commit();
}

/// Deletes a person from all backups, also if the deletion from one of them fails. True if all deletions
/// succeeded.
bool clean_backups(const fs::path& database, const std::string& person, CleanUp& done) {
  bool all = true;
  for (const fs::path& backup : backups_of(database)) {
    try {
      if (delete_from_backup(backup, person)) done.cleaned.push_back(backup);
    } catch (const base::Error& error) {
      done.left.push_back("backup " + std::string(error.what()) + ", or delete it");
      all = false;
    }
  }
  return all;
}

void clean_personal(const fs::path& database, const Chore& chore, CleanUp& done) {
  const fs::path personal = PersonalFile::beside(database);
  std::error_code ignored;
  if (!fs::exists(personal, ignored)) return;
  if (chore.kind == "rename")
    PersonalFile(database).rename(chore.batch, chore.codes);
  else
    PersonalFile(database).forget(chore.participant);
  done.cleaned.push_back(personal);
}

void do_chores(Connection& database, CleanUp& done) {
  const fs::path path = database.path();
  bool personal_waits = false;  // a chore on the personal file failed; skip the later chores on that file
  for (const Chore& chore : pending(database)) {
    try {
      if (chore.kind == "backups") {
        if (!clean_backups(path, chore.person, done)) continue;
      } else {
        if (personal_waits) continue;
        clean_personal(path, chore, done);
      }
      strike_out(database, chore);
    } catch (const std::exception& error) {
      if (chore.kind != "backups") personal_waits = true;
      done.left.emplace_back(error.what());
    }
  }
}

void empty_log(Connection& database) {
  if (database.integer("PRAGMA wal_checkpoint(TRUNCATE)") == 0) return;
  throw base::Error(database.path().string(),
                    "its -wal file still contains the deleted data: another program reads the database",
                    "close that program and give the command again");
}

void rewrite_file(Connection& database) {
  if (database.integer("SELECT count(*) FROM chore WHERE kind = 'rewrite'") == 0) return;
  empty_log(database);
  database.execute("VACUUM");
  empty_log(database);
  Transaction transaction(database);
  database.execute("DELETE FROM chore WHERE kind = 'rewrite'");
  transaction.commit();
}

template <class Value>
void keep_one_of_each(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

bool is_anything_left(Connection& database) {
  return database.integer("SELECT EXISTS (SELECT 1 FROM chore)") != 0 || holds_withdrawn(database);
}

void check_nothing_left(const fs::path& database, const std::vector<std::string>& left) {
  if (left.empty()) return;
  throw base::Error(database.string(),
                    left.size() == 1 ? "one clean-up named above is left"
                                     : std::to_string(left.size()) + " clean-ups named above are left",
                    "do what each line says; the next vip-study run, resume, withdraw or merge then finishes "
                    "the clean-up");
}

ChorePlan::ChorePlan(Connection& database)
    : database_(database), batch_(database.text("SELECT lower(hex(randomblob(16)))")) {}

void ChorePlan::forget(const std::string& person, const std::string& participant) {
  add("backups", person, participant);
  add("personal", person, participant);
}

void ChorePlan::rename(const std::map<std::string, Rename>& people) {
  for (const auto& [person, codes] : people) add("rename", person, codes.before, codes.now);
}

void ChorePlan::rewrite() {
  if (database_.integer("SELECT count(*) FROM chore WHERE kind = 'rewrite'") == 0) add("rewrite", "", "");
}

void ChorePlan::add(const char* kind, const std::string& person, const std::string& participant,
                    const std::string& renamed) {
  Statement insert(database_,
                   "INSERT INTO chore (kind, batch, person, participant, renamed) VALUES (?,?,?,?,?)");
  const auto other_name = renamed.empty() ? std::nullopt : std::optional(renamed);
  insert.bind_all(kind, batch_, person, participant, other_name).run();
}

CleanUp clean_up(Connection& database) {
  CleanUp done;
  if (!is_anything_left(database)) return done;
  database.execute("PRAGMA secure_delete = ON; PRAGMA temp_store = MEMORY");
  do_chores(database, done);
  try {
    delete_exports_of_withdrawn(database, done);
    rewrite_file(database);
  } catch (const std::exception& error) {
    done.left.emplace_back(error.what());
  }
  keep_one_of_each(done.cleaned);
  keep_one_of_each(done.left);
  return done;
}

CleanUp clean_up_all(Connection& database) {
  CleanUp done = clean_up(database);
  try {
    rewrite_journal(database);
  } catch (const std::exception& error) {
    done.left.emplace_back(error.what());
  }
  return done;
}

}  // namespace study
