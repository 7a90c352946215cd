#pragma once
/// Compares a database with its journal of answers (answer_journal.hpp), and reconciles the two when the
/// database is opened for writing.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The first line of a new journal beside this database.
std::string head_for(sqlite::Connection& database);

struct Comparison {
  std::string news;       ///< journal lines of database rows that the journal lacks or has with other values
  std::int64_t lost = 0;  ///< rows marked as kept in the journal that the database lacks
  std::int64_t answers = 0;    ///< answers among the lost rows
  std::int64_t different = 0;  ///< answers that differ between database and journal
};
/// Compares a database with the rows that its journal marks as kept.
Comparison compare(sqlite::Connection& database, const JournalRows& kept);
/// True if the journal contains rows that the database lacks, or answers that differ from the database's.
/// Different answers are ignored if the journal has an older schema, because its rows have other columns.
bool is_ahead(const Comparison& found, const JournalContent& content, sqlite::Connection& database);
/// A comparison in words: "2 answers and 7 other rows are in the journal only" or, if no row is lost, "2
/// answers differ from the journal".
std::string words_of(const Comparison& found);

/// Finishes the work that a program had begun when it was killed, as its journal shows, within the caller's
/// transaction. Inserts the rows of an interrupted commit and deletes the people of an unfinished withdrawal.
/// Then deletes gaze data of people who refuse gaze. Returns the persons whose gaze was deleted.
std::set<std::string> finish_what_was_begun(sqlite::Connection& database, const JournalContent& content);

/// The result of settle().
struct Settled {
  std::int64_t last_number = 0;        ///< largest batch number in the journal
  std::set<std::string> gaze_deleted;  ///< persons whose gaze was deleted because they refuse it
};
/// Reconciles database and journal: finish_what_was_begun(), then adds the database's other rows to the
/// journal. base::Error if the journal has rows that the database lacks, or other answers (is_ahead()), or if
/// the journal cannot be written.
Settled settle(sqlite::Connection& database, JournalFile& file);

/// Calls settle(), for callers that have no JournalFile; call it before any other write. Returns lines that
/// name the backups and exports which still contain gaze that settle() deleted.
std::vector<std::string> settle_before_writing(sqlite::Connection& database);

}  // namespace study
