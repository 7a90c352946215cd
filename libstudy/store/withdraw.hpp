#pragma once
/// A participant withdraws: what stands of them is deleted wherever it can be reached.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// What a withdrawal did, and what is left to the experimenter.
struct Withdrawal {
  std::int64_t sessions = 0, answers = 0, frames = 0;  ///< deleted from the database
  std::vector<std::filesystem::path> scrubbed;  ///< backups and personal files that were cleaned as well
  std::vector<std::string> exports;             ///< folders that may hold the data: delete or make them again
  std::vector<std::string>
      stations;  ///< where the sessions were recorded: their own databases are not reached
  /// Backups that could not be cleaned, each with the reason: delete them.
  std::vector<std::string> failed;
};

/// Deletes all rows of a participant but a tombstone from `database`, its log, the backups
/// ("<database>.v*.bak") and the file of personal data beside it, and overwrites where they stood; their slot
/// in the assignment is free again. May be repeated, to finish what was cut short. base::Error: no such
/// participant, or the database is in use.
Withdrawal withdraw(const std::filesystem::path& database, const std::string& participant);

/// What a withdrawal of `person` would delete and cannot reach.
Withdrawal take_stock(sqlite::Connection& database, const std::string& person);
/// Deletes every session of `person` and leaves the tombstone, within a transaction of the caller.
void bury(sqlite::Connection& database, const std::string& person);
/// Deletes a participant from the backups of `database` and from the personal file beside it; the results are
/// added to `done`. code: as given at the station, under which older backups know the participant.
void scrub_beside(const std::filesystem::path& database, const std::string& participant,
                  const std::string& code, Withdrawal& done);
/// Empties the log and rewrites the file, so that nothing stands in it but what its tables hold.
void rewrite(sqlite::Connection& database);

}  // namespace study
