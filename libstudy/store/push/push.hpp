#pragma once
/// Sends what is new in a station's database to the central database of a lab, and brings withdrawals back.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libstudy/store/study_file.hpp"

namespace study {

/// The result of a push.
struct Push {
  std::int64_t sessions = 0;    ///< in the file, also those that are left out
  std::int64_t sent = 0;        ///< of which something was sent
  std::int64_t older = 0;       ///< the centre has a later state of them; only permissions were joined
  std::int64_t withdrawn = 0;   ///< left out, because the person withdrew at the centre
  std::int64_t tombstones = 0;  ///< withdrawals that the centre did not have
  std::int64_t rows = 0, bytes = 0;
  /// Sessions of which nothing more was sent, each with the reason; rows of a refused transaction are
  /// nowhere.
  std::vector<std::string> refused;
};

/// Sends to the central database of `service` (central/postgres.hpp) what it does not have yet: withdrawals
/// first, then sessions in the order of planning. A session's small tables are replaced together in one
/// transaction, then rows of its large tables (frames, gaze) follow, each presentation's once. The centre
/// keeps a digest of every part, so that a push that was cut off goes on, and one that is repeated sends
/// nothing. Progress never goes back: an older copy of a session changes nothing but permissions, of which a
/// refusal in any copy stays.
///
/// Nothing is sent of the personal file, of exports, or of events without a session.
///
/// base::Error (pg::Failure) if the connection ends; what was committed stays, and the next push goes on.
/// base::Error if the schema of the centre is not that of this program, or another push of this station runs.
/// told: called before each session with the number of sessions done and of all.
Push push(const StudyFile& study, const std::string& service,
          const std::function<void(std::int64_t done, std::int64_t all)>& told = {});

/// Codes of the people in a database who withdrew at the centre; withdraw() them. The centre tells nothing of
/// other people: it is asked about the random identities that the file has.
std::vector<std::string> withdrawn_at_centre(const StudyFile& study, const std::string& service);

}  // namespace study
