/// Functions of Store that write participants' permissions, gaze if it is allowed, the facts and recordings
/// of a headset, clock offsets of eye trackers, and markers.
#include <array>
#include <tuple>

#include "libstudy/store/permissions.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

bool Store::allows_gaze(std::int64_t session) { return is_gaze_allowed(*database_, session); }

std::int64_t Store::session_of(std::int64_t presentation) {
  Statement row(*database_,
                "SELECT session_id FROM presentation JOIN trial USING (trial_id) WHERE presentation_id = ?");
  return row.bind_all(presentation).step() ? row.integer(0) : 0;
}

void Store::require_gaze_allowed(std::int64_t session) {
  if (allows_gaze(session)) return;
  throw base::Error(path_.string(), "stores no gaze of a participant who refused it or was not asked",
                    "record no gaze after a refusal; to ask, put the question gaze_kept in a block of kind "
                    "consent of the protocol");
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

/// Applies a consent answer about gaze or sharing. If the experimenter changed this permission before, the
/// answer overrides the change. If gaze is now refused, deletes gaze recorded earlier.
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

namespace {

void insert_head(Statement& insert, std::int64_t presentation, std::int64_t slot, const HeadPose& head) {
  std::array<std::optional<double>, 3> place;
  std::array<std::optional<double>, 4> turn;
  for (std::size_t k = 0; head.place_valid && k < place.size(); ++k) place[k] = head.place_m[k];
  for (std::size_t k = 0; head.turn_valid && k < turn.size(); ++k) turn[k] = head.turn[k];
  insert
      .bind_all(presentation, slot, place[0], place[1], place[2], turn[0], turn[1], turn[2], turn[3],
                head.place_valid && head.place_tracked ? 1 : 0, head.turn_valid && head.turn_tracked ? 1 : 0)
      .run();
}

}  // namespace

/// Compares with the session's last row all columns but the fields of view, which vary slightly between equal
/// headsets. Measured refresh rates within .5 % are equal.
void Store::add_headset(std::int64_t session, const HeadsetFacts& headset) {
  const auto& [left, right] = headset.eyes;
  Transaction transaction(*database_);
  Statement(*database_,
            "INSERT INTO headset SELECT NULL, v.* FROM (SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, "
            "?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21, ?22, ?23, ?24) v WHERE NOT EXISTS (SELECT 1 "
            "FROM headset WHERE headset_id = (SELECT max(headset_id) FROM headset WHERE session_id = ?1) AND "
            "(runtime, runtime_version, headset, left_width_px, left_height_px, right_width_px, "
            "right_height_px, format, refresh_told_hz, hold, blend, times_convert, position_tracking, "
            "eye_tracking) IS (?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?20, ?21, ?22, ?23, ?24) AND "
            "coalesce(abs(refresh_measured_hz / ?11 - 1) < 0.005, refresh_measured_hz IS ?11))")
      .bind_all(session, headset.runtime, headset.runtime_version, headset.headset, left.width_px,
                left.height_px, right.width_px, right.height_px, headset.format, headset.refresh_told_hz,
                headset.refresh_measured_hz, left.left_deg, left.right_deg, left.up_deg, left.down_deg,
                right.left_deg, right.right_deg, right.up_deg, right.down_deg, headset.hold, headset.blend,
                headset.times_convert ? 1 : 0, headset.position_tracking ? 1 : 0,
                headset.eye_tracking ? 1 : 0)
      .run();
  commit(transaction);
}

void Store::add_ipd(std::int64_t session, std::int64_t clock_ns, double ipd_mm) {
  Transaction transaction(*database_);
  Statement(
      *database_,
      "INSERT INTO ipd (session_id, clock_ns, ipd_mm) SELECT ?1, ?2, ?3 WHERE NOT EXISTS (SELECT 1 FROM "
      "ipd WHERE ipd_id = (SELECT max(ipd_id) FROM ipd WHERE session_id = ?1) AND "
      "abs(ipd_mm - ?3) <= ?4)")
      .bind_all(session, clock_ns, ipd_mm, ipd_change_mm)
      .run();
  commit(transaction);
}

void Store::add_slots(std::int64_t presentation, std::int64_t start_ns, std::span<const ShownSlot> slots) {
  Transaction transaction(*database_);
  Statement next(*database_, "SELECT coalesce(max(slot_index) + 1, 0) FROM slot WHERE presentation_id = ?");
  next.bind_all(presentation).step();
  std::int64_t index = next.integer(0);
  next.reset();
  bool asked = false;
  Statement insert(*database_, "INSERT INTO slot VALUES (?,?,?,?,?,?)");
  Statement head(*database_, "INSERT INTO head VALUES (?,?,?,?,?,?,?,?,?,?,?)");
  for (const ShownSlot& shown : slots) {
    const SlotRecord& slot = shown.slot;
    insert
        .bind_all(presentation, index, slot.predicted_ns - start_ns, slot.period_ns,
                  slot.should_render ? 1 : 0, shown.frame)
        .run();
    if (slot.head && !asked) require_gaze_allowed(session_of(presentation));
    asked = asked || slot.head;
    if (slot.head) insert_head(head, presentation, index, *slot.head);
    ++index;
  }
  commit(transaction);
}

void Store::add_validation(std::int64_t session, std::span<const ValidatedPoint> points, bool passed) {
  Transaction transaction(*database_);
  require_gaze_allowed(session);
  Statement next(*database_,
                 "SELECT coalesce(max(validation) + 1, 1) FROM gaze_validation WHERE session_id = ?");
  next.bind_all(session).step();
  const std::int64_t validation = next.integer(0);
  next.reset();
  Statement insert(*database_, "INSERT INTO gaze_validation VALUES (?,?,?,?,?,?,?,?,?,?,?,?)");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ValidatedPoint& point = points[i];
    insert
        .bind_all(session, validation, static_cast<std::int64_t>(i), point.clock_ns, point.azimuth_deg,
                  point.elevation_deg, point.samples, point.valid, point.accuracy_deg, point.sd_deg,
                  point.rms_s2s_deg, passed ? 1 : 0)
        .run();
  }
  commit(transaction);
}

void Store::add_tracker_clocks(std::int64_t session, std::span<const TrackerClock> clocks) {
  if (clocks.empty()) return;
  Transaction transaction(*database_);
  Statement insert(*database_, "INSERT INTO tracker_clock VALUES (NULL,?,?,?,?,?,?,?,?,?,?)");
  for (const TrackerClock& clock : clocks) {
    insert
        .bind_all(session, clock.source, clock.device, clock.turn_deg[0], clock.turn_deg[1],
                  clock.turn_deg[2], clock.clock_ns, clock.offset_ns, clock.round_trip_ns,
                  marker_utc(utc_ns_of(clock.clock_ns)))
        .run();
  }
  commit(transaction);
}

std::vector<std::string> Store::marker_receivers(std::int64_t session) {
  Statement row(*database_, "SELECT DISTINCT receiver FROM marker WHERE session_id = ? ORDER BY receiver");
  std::vector<std::string> receivers;
  for (row.bind_all(session); row.step();) receivers.push_back(row.text(0));
  return receivers;
}

void Store::add_markers(std::int64_t session, std::span<const MarkerRecord> markers) {
  if (markers.empty()) return;
  const auto least = [](std::int64_t number, std::int64_t bound) {
    return number < bound ? std::nullopt : std::optional(number);
  };
  Transaction transaction(*database_);
  Statement insert(*database_, "INSERT INTO marker VALUES (NULL,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  for (const MarkerRecord& record : markers) {
    const Marker& marker = record.marker;
    const bool lost = !record.lost.empty();
    insert
        .bind_all(session, record.receiver, marker_name(marker.kind), marker_code(marker), marker.slot,
                  least(marker.position, 0), least(marker.attempt, 1), least(marker.stimulus, 1),
                  marker.clock_ns, least(marker.display_ns, 0), marker_utc(marker.utc_ns),
                  lost ? std::nullopt : std::optional(record.written_ns - marker.clock_ns),
                  lost ? std::optional(record.lost) : std::nullopt)
        .run();
  }
  commit(transaction);
}

}  // namespace study
