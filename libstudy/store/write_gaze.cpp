/// Store: writes permissions of participants, and gaze if it is allowed.
#include <array>
#include <tuple>

#include "libstudy/store/permissions.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

bool Store::allows_gaze(std::int64_t session) { return is_gaze_allowed(*database_, session); }

/// The session of a running presentation.
std::int64_t Store::session_of(std::int64_t presentation) {
  Statement row(*database_,
                "SELECT session_id FROM presentation JOIN trial USING (trial_id) WHERE presentation_id = ?");
  return row.bind_all(presentation).step() ? row.integer(0) : 0;
}

void Store::require_gaze_allowed(std::int64_t session) {
  if (allows_gaze(session)) return;
  throw base::Error(path_.string(), "takes no gaze of a participant who has not allowed it",
                    "ask gaze_kept on a page of kind consent");
}

void Store::add_gaze(std::int64_t presentation, std::int64_t start_ns, GazeOrigin origin,
                     std::span<const GazeSample> samples) {
  Transaction transaction(*database_);
  require_gaze_allowed(session_of(presentation));
  Statement insert(*database_,
                   "INSERT INTO gaze SELECT ?1, coalesce((SELECT max(sample_index) + 1 FROM gaze WHERE "
                   "presentation_id = ?1), 0), ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14");
  constexpr std::array names{"tracker", "head", "mouse"};
  for (const GazeSample& sample : samples) {
    std::optional<double> x, y;
    if (sample.point) std::tie(x, y) = *sample.point;
    std::optional<int> tracked;
    if (sample.tracked) tracked = *sample.tracked ? 1 : 0;
    std::array<std::optional<double>, 3> from, along;
    for (std::size_t k = 0; sample.ray && k < 3; ++k) {
      from[k] = sample.ray->origin_m[k];
      along[k] = sample.ray->direction[k];
    }
    insert
        .bind_all(presentation, names.at(static_cast<std::size_t>(origin)), sample.sampled_ns - start_ns,
                  sample.device_ns, sample.valid ? 1 : 0, x, y, tracked, from[0], from[1], from[2], along[0],
                  along[1], along[2])
        .run();
  }
  commit(transaction);
}

/// A consent answer given after the experimenter changed a permission overrides that change. A refusal
/// deletes earlier recordings.
void Store::answer_over_change(std::int64_t session, const std::string& question, const std::string& now) {
  if (question != gaze_question && question != sharing_question) return;
  const std::string what = question == gaze_question ? "gaze" : "sharing";
  Statement row(*database_,
                "SELECT answered FROM permission_answer WHERE session_id = ?1 AND what = ?2 "
                "AND EXISTS (SELECT 1 FROM permission_change WHERE session_id = ?1 AND what = ?2)");
  if (row.bind_all(session, what).step()) {
    const bool allowed = row.integer(0) == 1;
    row.reset();
    record_permission(*database_, session, what, allowed, now);
  }
  delete_refused_gaze(*database_);
}

}  // namespace study
