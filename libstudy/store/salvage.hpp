#pragma once
/// Makes a sound database of what is left of a damaged one and of its journal of answers.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace study {

/// What a salvage found.
struct Salvage {
  bool sound = false;                  ///< SQLite reads the whole database and finds nothing wrong with it
  bool journal = false;                ///< there is a journal
  std::int64_t sessions = 0;           ///< in the new database
  std::int64_t answers_database = 0;   ///< answers that stood in the database, in the journal as well or not
  std::int64_t answers_journal = 0;    ///< answers that stood in the journal alone
  std::int64_t answers_under_way = 0;  ///< of these, answers whose commit the journal does not know of
  std::int64_t frames = 0;             ///< all from the database: the journal has none
  std::int64_t frames_lost = 0;        ///< of presentations that were played to the end
  std::int64_t unreadable = 0;         ///< lines of the journal
  /// Answers that the two tell otherwise; the database's stands in the new one.
  std::vector<std::string> different;
  /// Answers known to have been given that were found nowhere: number by participant.
  std::map<std::string, std::int64_t> answers_lost;
  /// Rows found that belong to nothing that was found: number by table.
  std::map<std::string, std::int64_t> rows_lost;
  /// Of the database, but not of vip-study: tables, views, triggers and columns, and a log of another
  /// database.
  std::vector<std::string> left_out;
  std::vector<std::string> withdrawn;  ///< codes of those who withdrew: nothing of theirs was taken over
};

/// Writes `into`, of the newest schema, mode 0600, with a journal of its own: whole or not at all. `database`
/// may be damaged, cut short, empty or gone; it, its log and its journal stay as they are. What was answered
/// counts as the database has it, and as the journal has it where the database has nothing. base::Error:
/// `into` exists, another vip-study writes `database`, nothing was found, or the journal is of another study.
Salvage salvage(const std::filesystem::path& database, const std::filesystem::path& into);

}  // namespace study
