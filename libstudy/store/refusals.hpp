#pragma once
/// Deletes gaze data after a refusal: gaze samples, head poses and validations of the eye tracker. The rows
/// to delete follow from the stored permissions (permissions.hpp), not from the command that recorded them,
/// so that a kill cannot leave gaze of somebody who refused.

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// Deletes gaze data of sessions in which gaze is not allowed now, and plans a rewrite of the file
/// (chores.hpp). Call it when a database is opened for writing, and in the transaction of each answer or
/// change. Returns the persons whose gaze was deleted.
std::set<std::string> delete_refused_gaze(sqlite::Connection& database);

/// The same for a union of databases. Also deletes gaze recorded before a refusal that was later withdrawn,
/// because that gaze may come from a copy that has neither change.
void drop_unallowed_gaze(sqlite::Connection& database);

/// SQL condition on rows of gaze, head or gaze_validation: gaze is allowed now in their session. Exports
/// apply it too and do not rely on earlier deletions.
std::string gaze_allowed_sql(const std::string& table);
/// True if gaze is allowed now in a session.
bool is_gaze_allowed(sqlite::Connection& database, std::int64_t session);

std::int64_t count_gaze(sqlite::Connection& database, const std::string& person);
std::set<std::string> people_with_gaze(sqlite::Connection& database);
/// Persons with a session in which gaze is refused now.
std::set<std::string> people_without_gaze(sqlite::Connection& database);

/// Files that may still hold gaze of a person and that no program deletes.
struct GazeElsewhere {
  std::vector<std::string> backups;  ///< beside the database
  std::vector<std::string> exports;  ///< all with the person: the register does not say which have gaze
};
GazeElsewhere find_gaze_elsewhere(sqlite::Connection& database, const std::string& person);
/// The same for several persons, as lines for the experimenter, who must delete them.
std::vector<std::string> name_gaze_elsewhere(sqlite::Connection& database,
                                             const std::set<std::string>& persons);

}  // namespace study
