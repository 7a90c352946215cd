#pragma once
/// Makes a sound database from the remains of a damaged one and its journal of answers.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace study {

/// The result of a salvage.
struct Salvage {
  bool sound = false;                  ///< SQLite can read the whole database and finds no error
  bool journal = false;                ///< there is a journal
  std::int64_t sessions = 0;           ///< in the new database
  std::int64_t answers_database = 0;   ///< answers in the database, whether or not also in the journal
  std::int64_t answers_journal = 0;    ///< answers only in the journal
  std::int64_t answers_under_way = 0;  ///< of these, answers that the journal does not mark as kept
  std::int64_t frames = 0;             ///< all from the database: the journal has none
  std::int64_t frames_lost = 0;        ///< of presentations that were played to the end
  std::int64_t unreadable = 0;         ///< lines of the journal
  /// Answers that differ between database and journal; the new database has the database's version.
  std::vector<std::string> different;
  /// Number of answers, by participant, that are known to have been given but were not found.
  std::map<std::string, std::int64_t> answers_lost;
  /// Number of rows, by table, whose parent was not found.
  std::map<std::string, std::int64_t> rows_lost;
  /// Parts of the database that are not from vip-study: tables, views, triggers and columns, and a log of
  /// another database.
  std::vector<std::string> left_out;
  std::vector<std::string> withdrawn;  ///< codes of those who withdrew; none of their data are in the result
};

/// Writes `into`, of the newest schema, mode 0600, with a journal of its own: whole or not at all. `database`
/// may be damaged, truncated, empty or missing; it, its log and its journal stay unchanged. Answers come from
/// the database, or from the journal if the database lacks them. base::Error: `into` exists, another
/// vip-study writes `database`, nothing was found, or the journal is of another study.
Salvage salvage(const std::filesystem::path& database, const std::filesystem::path& into);

}  // namespace study
