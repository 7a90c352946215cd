#pragma once
/// Withdrawal of a participant: deletes their data wherever they can be reached.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// The data of a person in a database.
struct Stock {
  std::int64_t sessions = 0, answers = 0, frames = 0;
  std::vector<std::string> stations;  ///< that recorded the sessions: their own databases are not reached
};

/// The result of a withdrawal, and the work left to the experimenter.
struct Withdrawal {
  Stock deleted;   ///< from the database
  CleanUp beside;  ///< backups, personal data and exports
};

/// Kind of the event of a session whose participant asked at its end to delete all data. The withdrawal
/// deletes the event too: if it exists, the withdrawal is still to be done. A Store does it when it is
/// opened.
inline constexpr const char* withdrawal_request = "withdrawal wished";

/// Participants with an event withdrawal_request. base::Error as read_tasks().
std::vector<std::string> requested_withdrawals(const StudyFile& study);
std::vector<std::string> requested_withdrawals(sqlite::Connection& database);

/// Deletes all rows of a participant but a tombstone from `database`, its log, its backups, the personal file
/// beside it and every registered export, and overwrites their bytes; their slot in the assignment is free
/// again. If a kill interrupts it, repeat it or open the database for writing. May be repeated to finish the
/// rest. base::Error: no such participant, or the database is in use.
Withdrawal withdraw(const std::filesystem::path& database, const std::string& participant);
/// The same for a database that is open for writing under its WriterLock.
Withdrawal withdraw(sqlite::Connection& database, const std::string& participant);

Stock take_stock(sqlite::Connection& database, const std::string& person);

}  // namespace study
