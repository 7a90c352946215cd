#pragma once
/// Withdrawal of a participant: deletes their data from the database and the files that the program knows.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Amount of a person's data in a database.
struct Stock {
  std::int64_t sessions = 0, answers = 0, frames = 0;
  std::vector<std::string> stations;  ///< stations of the sessions; the databases there stay unchanged
  /// Program and SHA-256 of each file from which sessions were imported; the files stay unchanged.
  std::vector<std::string> sources = {};
};

/// The result of a withdrawal, with the files that the experimenter must handle.
struct Withdrawal {
  Stock deleted;   ///< data deleted from the database
  CleanUp beside;  ///< clean-up of backups, personal data and exports
};

/// Kind of the event for a participant who asked at the end of a session to delete all data. The withdrawal
/// deletes the event, so an existing event means that the withdrawal is still to be done. Store's constructor
/// does the withdrawal.
inline constexpr const char* withdrawal_request = "withdrawal wished";

/// Codes of the participants with an event withdrawal_request. base::Error if the database cannot be opened
/// or, unless study.incomplete, lacks rows of its journal of answers.
std::vector<std::string> requested_withdrawals(const StudyFile& study);
std::vector<std::string> requested_withdrawals(sqlite::Connection& database);

/// Deletes a participant's data from `database`, its log, its journal of answers, its backups and the
/// personal file, and overwrites the bytes. Also deletes registered exports (delete_exports_of_withdrawn()).
/// Only a tombstone stays: a row that says who withdrew. The participant's slot (position in the
/// counterbalancing) is free again. If a kill interrupts the withdrawal, repeat it or open the database with
/// a Store, which finishes it. Repeating also retries clean-ups that failed. base::Error if the participant
/// is unknown or the database is in use.
Withdrawal withdraw(const std::filesystem::path& database, const std::string& participant);
/// withdraw() for a database that is already open for writing under its WriterLock.
Withdrawal withdraw(sqlite::Connection& database, const std::string& participant);

Stock take_stock(sqlite::Connection& database, const std::string& person);

}  // namespace study
