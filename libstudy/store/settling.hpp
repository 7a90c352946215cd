#pragma once
/// How a database and its journal of answers stand to each other, and how whoever opens the database for
/// writing brings them together: AnswerJournal says what is in the journal when.

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/journal_file.hpp"
#include "libstudy/store/sqlite.hpp"

namespace study {

/// The first line of a journal beside this database.
std::string head_for(sqlite::Connection& database);

struct Comparison {
  std::string news;            ///< rows that the database has and the journal has not, or otherwise
  std::int64_t lost = 0;       ///< rows that were kept and that the database does not have
  std::int64_t answers = 0;    ///< responses among them
  std::int64_t different = 0;  ///< answers that the database has otherwise than they were kept
};
/// Of a database with the rows that its journal says are kept.
Comparison compare(sqlite::Connection& database, const JournalRows& kept);
/// Whether the journal knows more than the database. One of an older schema has the same rows with other
/// columns.
bool is_ahead(const Comparison& found, const JournalContent& content, sqlite::Connection& database);
/// "2 answers and 7 other rows stand in the journal alone".
std::string words_of(const Comparison& found);

/// Does what the journal calls for and no longer depends on the program that began it, each within a
/// transaction of the caller: rows whose commit was under way are put in, and whoever is named in a
/// withdrawal that was not finished is deleted. Then what was recorded of people who refuse gaze is deleted.
/// Returns the persons whose gaze was deleted.
std::set<std::string> finish_what_was_begun(sqlite::Connection& database, const JournalContent& content);

/// What settle() did.
struct Settled {
  std::int64_t last_number = 0;        ///< largest number of a batch in use
  std::set<std::string> gaze_deleted;  ///< persons whose gaze was deleted, as they refuse it
};
/// Brings both together. base::Error: the journal knows more than the database, or cannot be written.
Settled settle(sqlite::Connection& database, JournalFile& file);

/// settle() before anything else is written, for who keeps no journal open. Returns lines that name the
/// backups and exports that hold what was deleted.
std::vector<std::string> settle_before_writing(sqlite::Connection& database);

}  // namespace study
