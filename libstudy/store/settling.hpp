#pragma once
/// Compares a database with its journal of answers and reconciles them when the database is opened for
/// writing. AnswerJournal describes the journal.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The first line of this database's journal.
std::string head_for(sqlite::Connection& database);

struct Comparison {
  std::string news;            ///< rows of the database that are missing or different in the journal
  std::int64_t lost = 0;       ///< kept rows that the database lacks
  std::int64_t answers = 0;    ///< answers among the lost rows
  std::int64_t different = 0;  ///< answers that differ between database and journal
};
/// Compares a database with the kept rows of its journal.
Comparison compare(sqlite::Connection& database, const JournalRows& kept);
/// True if the journal holds more than the database. Differences do not count if the journal is of an older
/// schema, whose rows have other columns.
bool is_ahead(const Comparison& found, const JournalContent& content, sqlite::Connection& database);
/// "2 answers and 7 other rows stand in the journal alone".
std::string words_of(const Comparison& found);

/// Finishes what an ended program began, by its journal, within the caller's transaction: inserts rows whose
/// commit was under way and deletes people of an unfinished withdrawal. Then deletes gaze data of people who
/// refuse gaze. Returns the persons whose gaze was deleted.
std::set<std::string> finish_what_was_begun(sqlite::Connection& database, const JournalContent& content);

/// The result of settle().
struct Settled {
  std::int64_t last_number = 0;        ///< largest number of a batch in use
  std::set<std::string> gaze_deleted;  ///< persons whose gaze was deleted because they refuse it
};
/// Reconciles database and journal. base::Error: the journal holds more than the database, or cannot be
/// written.
Settled settle(sqlite::Connection& database, JournalFile& file);

/// Calls settle() before anything else is written, for callers without an open journal. Returns lines that
/// name backups and exports that hold deleted gaze.
std::vector<std::string> settle_before_writing(sqlite::Connection& database);

}  // namespace study
