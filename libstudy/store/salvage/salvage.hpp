#pragma once
/// Makes a new, sound database from what is left of a damaged database and of its journal of answers.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace study {

/// The result of a salvage.
struct Salvage {
  bool sound = false;                  ///< SQLite can read the whole database and finds no error
  bool journal = false;                ///< the journal of answers exists
  std::int64_t sessions = 0;           ///< number of sessions in the new database
  std::int64_t answers_database = 0;   ///< number of answers from the damaged database
  std::int64_t answers_journal = 0;    ///< number of answers that only the journal contains
  std::int64_t answers_under_way = 0;  ///< how many of answers_journal are not marked as kept (committed)
  std::int64_t frames = 0;             ///< number of frames in the new database; the journal contains none
  std::int64_t frames_lost = 0;        ///< number of missing frames of presentations played to the end
  std::int64_t unreadable = 0;         ///< number of unreadable lines in the journal
  /// Answers that differ between database and journal; the new database has the database's version.
  std::vector<std::string> different;
  /// Number of missing answers to questions of units that are done, by participant. Personal questions and
  /// excluded trials do not count.
  std::map<std::string, std::int64_t> answers_lost;
  /// Number of omitted rows by table: the row's parent row was not found, or a row of the journal violates
  /// the schema. Not counted if a person withdrew.
  std::map<std::string, std::int64_t> rows_lost;
  /// Parts of the database that are not from vip-study: tables, views, triggers and columns, and a log of
  /// another database.
  std::vector<std::string> left_out;
  std::vector<std::string> withdrawn;  ///< codes of people who withdrew; their data are not in the result
};

/// Writes the new database `into` completely or not at all, with the newest schema, mode 0600 and a journal
/// of answers. `database` may be damaged, truncated, empty or missing; the file, its log and its journal stay
/// unchanged. An answer comes from the database, or from the journal if the database lacks it. base::Error if
/// `into`, its journal or its log exists, if another vip-study writes `database`, if no data were found, or
/// if the journal belongs to another study.
Salvage salvage(const std::filesystem::path& database, const std::filesystem::path& into);

}  // namespace study
