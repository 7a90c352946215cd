#include "libstudy/store/open_study.hpp"

#include <algorithm>
#include <map>
#include <mutex>

#include "libstudy/store/file/backups.hpp"
#include "libstudy/store/file/beside.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/settling.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using journal::Row;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;

namespace {

constexpr int most_rounds = 5;

bool is_of(const Row& row, const char* table) { return row.table->name == std::string(table); }

bool stands(Connection& database, const Row& row) {
  const auto now = journal::stands_as(database, row);
  return now && now->line == row.line;
}

/// Persons who withdrew according to the journal but still have sessions in the database.
std::vector<std::string> withdrawn(Connection& database, const JournalContent& content) {
  std::set<std::string> named;
  for (const JournalRows* rows : {&content.kept, &content.pending}) {
    for (const auto& [key, row] : *rows) {
      if (is_of(row, "tombstone")) named.insert(journal::column(row, "person"));
    }
  }
  if (content.rewriting) named.insert(content.forgotten.begin(), content.forgotten.end());
  std::vector<std::string> here;
  Statement session(database, "SELECT 1 FROM session WHERE person = ?");
  for (const std::string& person : named) {
    if (session.bind_all(person).step()) here.push_back(person);
    session.reset();
  }
  return here;
}

/// Writes into `copy` the journal's permission changes and consent answers that the database lacks or has
/// with other values. Skips a row whose parent is missing: its session, and so the data to withhold, are
/// missing too.
void take_decisions(Connection& copy, const JournalRows& rows) {
  Statement asks(copy,
                 "SELECT 1 FROM question WHERE question_id = ? AND code IN ('gaze_kept', 'data_shared')");
  for (const auto& [key, row] : rows) {
    bool decides = is_of(row, "permission_change");
    if (is_of(row, "response")) {
      decides = asks.bind_all(journal::column(row, "question_id")).step();
      asks.reset();
    }
    if (decides && !stands(copy, row)) journal::put(copy, row, journal::Put::Replace);
  }
}

/// Differences between a database and its journal of answers.
struct Findings {
  bool ahead = false;   ///< the journal has rows that the database lacks, or other answers (is_ahead())
  bool begun = false;   ///< the journal contains rows of an interrupted commit
  std::string lacking;  ///< how the database lags behind, in words (words_of())
  std::vector<std::string> withdrawn;
};

Findings look(Connection& database, const JournalContent& content) {
  Findings found;
  if (!content.exists) return found;
  found.withdrawn = withdrawn(database, content);
  if (content.rewriting) return found;  // the journal's rows are older than the database: do not compare
  const Comparison comparison = compare(database, content.kept);
  found.ahead = is_ahead(comparison, content, database);
  if (found.ahead) found.lacking = words_of(comparison);
  found.begun = std::any_of(content.pending.begin(), content.pending.end(),
                            [&](const auto& one) { return !stands(database, one.second); });
  return found;
}

/// A temporary copy in the state that settle() would give the database. If the journal is ahead
/// (found.ahead), settle() would throw: the copy then includes, of the rows that only the journal has, the
/// permission changes and consent answers.
std::unique_ptr<Connection> as_settled(Connection& database, const JournalContent& content,
                                       const Findings& found) {
  auto copy = std::make_unique<Connection>(database.path(), sqlite::Temporary{});
  copy->copy_from(database);
  copy->execute("PRAGMA foreign_keys = ON");
  sqlite::Transaction transaction(*copy);
  if (found.ahead) {
    take_decisions(*copy, content.kept);
    take_decisions(*copy, content.pending);
  }
  for (const std::string& person : found.withdrawn) bury(*copy, person, copy->integer("PRAGMA user_version"));
  JournalContent rest = content;
  if (found.ahead) rest.pending.clear();
  finish_what_was_begun(*copy, rest);
  transaction.commit();
  copy->execute("PRAGMA query_only = ON");
  return copy;
}

[[noreturn]] void refuse(const fs::path& database, const Findings& found) {
  throw base::Error(
      database.string(),
      "lacks a part of what " + journal_beside(database).filename().string() +
          " says it holds: " + found.lacking,
      "put back the database that was written last with its -wal file, or run vip-study salvage "
      "--db " +
          database.string() + " --into NEW.db, which puts both together; --incomplete goes on without it");
}

/// The central databases that this process has read.
struct CentralStudies {
  std::mutex turn;
  CentralReading read;
  std::map<std::string, std::unique_ptr<Connection>> known;
};

CentralStudies& central_studies() {
  static CentralStudies studies;
  return studies;
}

OpenedStudy open_central_study(const std::string& service) {
  CentralStudies& studies = central_studies();
  const std::lock_guard guard(studies.turn);
  if (!studies.read)
    throw base::Error("service:" + service, "is a central database, which this program does not read",
                      "read it with vip-stats report");
  auto& known = studies.known[service];
  if (!known) known = studies.read(service);
  auto copy = std::make_unique<Connection>(known->path(), sqlite::Temporary{});
  copy->copy_from(*known);
  copy->execute("PRAGMA foreign_keys = ON; PRAGMA query_only = ON");
  return {std::move(copy), ""};
}

}  // namespace

void read_central_with(CentralReading reading) { central_studies().read = std::move(reading); }

OpenedStudy open_study(const StudyFile& study) {
  if (const auto service = service_of(study.path)) return open_central_study(*service);
  const fs::path path = real_file(study.path);
  for (int round = 1;; ++round) {
    // Read the journal before the database: the database then has all rows that the journal marks as kept.
    const JournalContent content = read_journal(journal_beside(path));
    auto database = open_database(path, Open::Read, read_schema_steps());
    database->execute("BEGIN");
    const Findings found = look(*database, content);
    if (found.ahead && round < most_rounds) {
      // Read both again if the journal changed in the meantime, e.g. by a withdrawal.
      const JournalContent now = read_journal(journal_beside(path));
      if (now.rewriting || now.end != content.end) continue;
    }
    if (found.ahead && !study.incomplete) refuse(study.path, found);
    const bool as_it_is = !found.ahead && !found.begun && found.withdrawn.empty();
    auto opened = as_it_is ? nullptr : as_settled(*database, content, found);
    database->execute("COMMIT");
    return {opened ? std::move(opened) : std::move(database), found.lacking};
  }
}

std::string lacking_of(const fs::path& database) { return open_study({database, true}).lacking; }

}  // namespace study
