#pragma once
/// A participant withdraws: what stands of them is deleted wherever it can be reached.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/chores.hpp"
#include "libstudy/store/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// What stood of a person in a database.
struct Stock {
  std::int64_t sessions = 0, answers = 0, frames = 0;
  std::vector<std::string>
      stations;  ///< where the sessions were recorded: their own databases are not reached
};

/// What a withdrawal did, and what is left to the experimenter.
struct Withdrawal {
  Stock deleted;   ///< from the database
  CleanUp beside;  ///< backups, personal data and exports
};

/// Kind of the event that stands in a session whose participant wished, at the end of it, that all be
/// deleted. It goes with what is deleted: where it stands, the withdrawal is still to be done. A Store does
/// it when it is opened.
inline constexpr const char* withdrawal_wish = "withdrawal wished";

/// Participants with such an event. base::Error as read_tasks().
std::vector<std::string> wished_withdrawals(const StudyFile& study);
std::vector<std::string> wished_withdrawals(sqlite::Connection& database);

/// Deletes all rows of a participant but a tombstone from `database`, its log, its backups, the file of
/// personal data beside it and every registered export, and overwrites where they stood; their slot in the
/// assignment is free again. A kill leaves nothing forgotten: repeat it, or open the database for writing.
/// May be repeated to finish what is left. base::Error: no such participant, or the database is in use.
Withdrawal withdraw(const std::filesystem::path& database, const std::string& participant);
/// Of a database that is open for writing under its WriterLock.
Withdrawal withdraw(sqlite::Connection& database, const std::string& participant);

Stock take_stock(sqlite::Connection& database, const std::string& person);

}  // namespace study
