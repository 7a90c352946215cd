/// What a participant allows, as the session writes it, and gaze where it is allowed.
#include <tuple>

#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

bool Store::allows_gaze(std::int64_t session) {
  Statement row(*database_,
                "SELECT 1 FROM permission WHERE session_id = ? AND what = 'gaze' AND granted = 1");
  return row.bind_all(session).step();
}

void Store::add_gaze(std::int64_t presentation, std::int64_t start_ns, GazeOrigin origin,
                     std::span<const GazeSample> samples) {
  Transaction transaction(*database_);
  Statement insert(
      *database_,
      "INSERT INTO gaze SELECT p.presentation_id, coalesce((SELECT max(sample_index) + 1 FROM gaze "
      "WHERE presentation_id = ?1), 0), ?2, ?3, ?4, ?5, ?6, ?7 FROM presentation p "
      "JOIN trial t USING (trial_id) WHERE p.presentation_id = ?1 AND EXISTS (SELECT 1 FROM "
      "permission a WHERE a.session_id = t.session_id AND a.what = 'gaze' AND a.granted = 1) "
      "RETURNING sample_index");
  for (const GazeSample& sample : samples) {
    std::optional<double> x, y;
    if (sample.point) std::tie(x, y) = *sample.point;
    insert.bind_all(presentation, origin == GazeOrigin::Tracker ? "tracker" : "mouse",
                    sample.sampled_ns - start_ns, sample.device_ns, sample.valid ? 1 : 0, x, y);
    const bool taken = insert.step();
    insert.reset();
    if (!taken) {
      throw base::Error(path_.string(), "takes no gaze of a participant who has not allowed it",
                        "ask gaze_kept on a page of kind consent");
    }
  }
  commit(transaction);
}

/// Who answers a consent page after the experimenter changed a permission has the last word.
void Store::answer_over_change(std::int64_t session, const std::string& question, const std::string& now) {
  if (question != gaze_question && question != sharing_question) return;
  Statement(
      *database_,
      "INSERT INTO permission_change (session_id, what, granted, utc) "
      "SELECT session_id, what, answered, ?3 FROM permission_answer WHERE session_id = ?1 AND what = ?2 "
      "AND what IN (SELECT what FROM permission_change WHERE session_id = ?1)")
      .bind_all(session, question == gaze_question ? "gaze" : "sharing", now)
      .run();
}

}  // namespace study
