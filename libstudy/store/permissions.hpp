#pragma once
/// What people allowed: answered on the consent page (gaze_kept, data_shared), or changed later by the
/// experimenter. gaze: where they look and how their head moves is recorded here; sharing: they stand in
/// public exports.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/refusals.hpp"
#include "libstudy/store/sqlite.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// The kind of the log's entries about a change.
inline constexpr const char* permission_event = "permission changed";

/// What holds for a session. True: allowed; false: refused, or asked and not answered yet; none: not asked.
struct SessionPermission {
  std::string protocol;  ///< name
  int visit = 1;
  std::optional<bool> gaze, sharing;
};

/// The sessions of a participant in the order of planning. base::Error: no such participant, or withdrawn.
std::vector<SessionPermission> read_permissions(const StudyFile& study, const std::string& participant);

/// Backups and exports that hold, or may hold, gaze of a participant (refusals.hpp). Errors as
/// read_permissions().
GazeElsewhere find_gaze_elsewhere(const StudyFile& study, const std::string& participant);

/// What the experimenter changes; none: left as it is.
struct PermissionWish {
  std::optional<bool> gaze, sharing;
};

/// What a change did, and what is left to the experimenter.
struct PermissionChange {
  std::int64_t gaze_deleted = 0;     ///< samples, with those of an earlier refusal that was cut short
  std::vector<std::string> backups;  ///< that hold gaze of the participant still: delete them
  std::vector<std::string> left;     ///< what could not be cleaned: place, reason and mend
  std::vector<std::string>
      gaze_exports;                  ///< that may hold gaze of the participant: delete or make them again
  std::vector<std::string> exports;  ///< public ones that hold the participant: delete or make them again
};

/// Writes down, for all sessions of a participant, what is allowed from now on; an answer that is given later
/// on a consent page counts again. A refusal of gaze deletes samples, head poses and validations, and
/// overwrites where they stood; what a kill leaves of it is done when the database is next opened for
/// writing. base::Error as read_permissions(), or the database is in use.
PermissionChange change_permissions(const std::filesystem::path& database, const std::string& participant,
                                    const PermissionWish& wish);

/// Writes down what is allowed in a session from now on, within a transaction of the caller. It counts
/// instead of all that the database holds about `what` ("gaze" or "sharing"): the order of rows decides, and
/// no clock. delete_refused_gaze() (refusals.hpp) is to follow.
void record_permission(sqlite::Connection& database, std::int64_t session, const std::string& what,
                       bool allowed, const std::string& utc);

/// How many people a public export holds and leaves out.
struct SharingCount {
  std::int64_t allowed = 0, not_asked = 0;     ///< in it
  std::int64_t refused = 0, not_answered = 0;  ///< left out, with all their sessions
};
SharingCount count_sharing(sqlite::Connection& database);

}  // namespace study
