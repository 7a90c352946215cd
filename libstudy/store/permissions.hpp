#pragma once
/// Permissions of participants: answered on the consent page (gaze_kept, data_shared), or changed later by
/// the experimenter. gaze: gaze and head poses may be recorded; sharing: data may be in public exports.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/refusals.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Kind of the log's events about a changed permission.
inline constexpr const char* permission_event = "permission changed";

/// Permissions of a session. True: allowed; false: refused, or asked and not answered yet; none: not asked.
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

/// The change that the experimenter requests; none: unchanged.
struct PermissionRequest {
  std::optional<bool> gaze, sharing;
};

/// The result of a change, and the work left to the experimenter.
struct PermissionChange {
  std::int64_t gaze_deleted = 0;          ///< samples, including those of an earlier, interrupted refusal
  std::vector<std::string> backups;       ///< that still hold gaze of the participant: delete them
  std::vector<std::string> left;          ///< files that could not be cleaned: place, reason and remedy
  std::vector<std::string> gaze_exports;  ///< that may hold gaze of the participant: delete or redo them
  std::vector<std::string> exports;       ///< public ones with the participant: delete or redo them
};

/// Records the new permissions for all sessions of a participant; a later answer on a consent page overrides
/// them. A refusal of gaze deletes samples, head poses and validations and overwrites their bytes; if a kill
/// interrupts this, the next opening for writing finishes it. base::Error as read_permissions(), or the
/// database is in use.
PermissionChange change_permissions(const std::filesystem::path& database, const std::string& participant,
                                    const PermissionRequest& request);

/// Records a permission of a session within the caller's transaction. It supersedes all that the database
/// holds about `what` ("gaze" or "sharing"): the order of rows decides, not a clock. Call
/// delete_refused_gaze() (refusals.hpp) afterwards.
void record_permission(sqlite::Connection& database, std::int64_t session, const std::string& what,
                       bool allowed, const std::string& utc);

/// Numbers of people in a public export and left out.
struct SharingCount {
  std::int64_t allowed = 0, not_asked = 0;     ///< in the export
  std::int64_t refused = 0, not_answered = 0;  ///< left out, with all their sessions
};
SharingCount count_sharing(sqlite::Connection& database);

}  // namespace study
