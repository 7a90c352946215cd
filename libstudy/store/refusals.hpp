#pragma once
/// What a refusal of gaze takes with it: samples of gaze, poses of the head, validations of the eye tracker.
/// What is to go follows from the permissions that stand (permissions.hpp), not from the command that
/// recorded them, so that no kill leaves gaze of somebody who refused.

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// Deletes what was recorded in sessions in which gaze is not allowed now, and plans the rewriting of the
/// file (chores.hpp). Whoever opens a database for writing calls it, and whoever records an answer or a
/// change, in the same transaction. Returns the persons whose gaze was deleted.
std::set<std::string> delete_refused_gaze(sqlite::Connection& database);

/// The same for a union of databases, with what was recorded before a refusal that was taken back later:
/// it may come from a copy that did not know of either.
void drop_unallowed_gaze(sqlite::Connection& database);

/// Condition on the rows of gaze, head or gaze_validation: recorded in a session in which gaze is allowed
/// now. Exports go by it themselves, whatever was deleted before.
std::string gaze_allowed_sql(const std::string& table);
/// The same of a session.
bool is_gaze_allowed(sqlite::Connection& database, std::int64_t session);

std::int64_t count_gaze(sqlite::Connection& database, const std::string& person);
std::set<std::string> people_with_gaze(sqlite::Connection& database);
/// Persons with a session in which gaze is refused now.
std::set<std::string> people_without_gaze(sqlite::Connection& database);

/// What holds gaze of a person still and no program deletes.
struct GazeElsewhere {
  std::vector<std::string> backups;  ///< beside the database
  std::vector<std::string> exports;  ///< all that hold the person: the register does not tell which have gaze
};
GazeElsewhere find_gaze_elsewhere(sqlite::Connection& database, const std::string& person);
/// The same as lines for who is to delete them, for several persons.
std::vector<std::string> name_gaze_elsewhere(sqlite::Connection& database,
                                             const std::set<std::string>& persons);

}  // namespace study
