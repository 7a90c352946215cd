#pragma once
/// Deletes gaze data of sessions in which gaze is refused: gaze samples, head poses and validations of the
/// eye tracker. The stored permissions (permissions.hpp) determine the rows to delete. So if a kill
/// interrupts the command that recorded a refusal, the next Store, withdrawal, merge or change of permissions
/// still deletes the rows.

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// Deletes gaze data of sessions in which gaze is not allowed now, and plans a rewrite of the file
/// (chores.hpp). Call it when a database is opened for writing, and in each transaction that changes a
/// permission. Returns the persons whose gaze was deleted.
std::set<std::string> delete_refused_gaze(sqlite::Connection& database);

/// Deletes gaze data that is not allowed from a union of databases. Also deletes gaze recorded before a
/// refusal, even if gaze was allowed again later: such gaze may come from a copy of the database that
/// contains neither the refusal nor the later permission.
void drop_unallowed_gaze(sqlite::Connection& database);

/// SQL condition that selects the rows of `table` (gaze, head or gaze_validation) whose session allows gaze
/// now. Exports use this condition too, so they do not depend on earlier deletions.
std::string gaze_allowed_sql(const std::string& table);
/// True if gaze is allowed now in a session.
bool is_gaze_allowed(sqlite::Connection& database, std::int64_t session);

std::int64_t count_gaze(sqlite::Connection& database, const std::string& person);
/// For each session with gaze data, by session.uid: the number of its gaze samples, head poses and
/// validations.
using GazeRows = std::map<std::string, std::int64_t>;
GazeRows gaze_rows(sqlite::Connection& database);
/// The persons with a session that has less gaze data than `before`, and in which gaze is not allowed now or
/// was refused earlier.
std::set<std::string> people_with_less_gaze(sqlite::Connection& database, const GazeRows& before);

/// Files outside the database that may still contain gaze of a person. The experimenter must delete these
/// files, because no command does.
struct GazeElsewhere {
  std::vector<std::string> backups;  ///< backups beside the database
  std::vector<std::string> exports;  ///< all exports with the person, as the register does not record gaze
};
GazeElsewhere find_gaze_elsewhere(sqlite::Connection& database, const std::string& person);
/// Files that may still contain gaze of these persons, as lines of text that ask the experimenter to delete
/// the files.
std::vector<std::string> name_gaze_elsewhere(sqlite::Connection& database,
                                             const std::set<std::string>& persons);

}  // namespace study
