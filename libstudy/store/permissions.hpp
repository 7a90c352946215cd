#pragma once
/// The permissions `gaze` and `sharing` of participants. gaze: gaze and head poses may be recorded; sharing:
/// the data may be in public exports. A participant grants or refuses them on the consent page (questions
/// gaze_kept and data_shared), and the experimenter can change them later.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/refusals.hpp"
#include "libstudy/store/study_file.hpp"

namespace study {

/// Kind of the log event for a permission that the experimenter changed.
inline constexpr const char* permission_event = "permission changed";

/// Permissions of one session. True: allowed; false: refused, or asked but not answered; none: not asked.
struct SessionPermission {
  std::string protocol;  ///< name of the protocol
  int visit = 1;
  std::optional<bool> gaze, sharing;
};

/// The permissions of all sessions of a participant, in the order of planning. base::Error if the code is
/// unknown, or if the participant withdrew.
std::vector<SessionPermission> read_permissions(const StudyFile& study, const std::string& participant);

/// Backups and exports that contain, or may contain, gaze of a participant (refusals.hpp). base::Error as
/// read_permissions().
GazeElsewhere find_gaze_elsewhere(const StudyFile& study, const std::string& participant);

/// The new permissions that the experimenter requests; none: the permission stays unchanged.
struct PermissionRequest {
  std::optional<bool> gaze, sharing;
};

/// The result of change_permissions(), and the files that the experimenter must handle.
struct PermissionChange {
  /// number of deleted gaze samples, with those that an interrupted earlier refusal left
  std::int64_t gaze_deleted = 0;
  std::vector<std::string> backups;       ///< backups that still contain the participant's gaze: delete them
  std::vector<std::string> left;          ///< files that could not be cleaned: path, reason and remedy
  std::vector<std::string> gaze_exports;  ///< exports that may contain the gaze: delete or repeat them
  std::vector<std::string> exports;       ///< public exports with the participant: delete or repeat them
};

/// Records new permissions for all sessions of a participant. A later answer on a consent page overrides
/// them. A refusal of gaze deletes gaze samples, head poses and eye-tracker validations and overwrites their
/// bytes. If a kill interrupts the deletion, the next Store, withdrawal, merge or change of permissions
/// finishes it. base::Error if the code is unknown, the participant withdrew, or the database is in use.
PermissionChange change_permissions(const std::filesystem::path& database, const std::string& participant,
                                    const PermissionRequest& request);

/// Records a permission of a session within the caller's transaction. The new row supersedes all earlier
/// answers and changes about `what` ("gaze" or "sharing"). The order of rows, not a clock, defines which of
/// them are earlier. Call delete_refused_gaze() (refusals.hpp) afterwards.
void record_permission(sqlite::Connection& database, std::int64_t session, const std::string& what,
                       bool allowed, const std::string& utc);

/// Numbers of people whom a public export includes and omits.
struct SharingCount {
  std::int64_t allowed = 0, not_asked = 0;     ///< people in the export
  std::int64_t refused = 0, not_answered = 0;  ///< people omitted with all their sessions
};
SharingCount count_sharing(sqlite::Connection& database);

}  // namespace study
