#include "libstudy/store/read/frame_times.hpp"

#include <algorithm>
#include <cstdint>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/open_study.hpp"

namespace study {

using sqlite::Statement;

namespace {

constexpr const char* shown_first_sql =
    "SELECT s.uid, t.position, p.presentation_id, coalesce(p.grade, 'D'), p.start_ns, "
    "coalesce(p.end_ns, -1), coalesce(p.frames, 0), p.animation_error_ms FROM trial t JOIN session s USING "
    "(session_id) "
    "JOIN protocol o USING (protocol_id) JOIN trial_showing w USING (trial_id) "
    "JOIN presentation p ON p.trial_id = t.trial_id AND p.attempt = w.attempt AND p.interval = 0 "
    "WHERE o.sha256 = ? AND p.state = 'played'";

constexpr const char* frame_onsets_sql =
    "SELECT scheduled_ns, submitted_ns, predicted_display_ns, actual_display_ns FROM frame "
    "WHERE presentation_id = ? ORDER BY frame_index";

/// The time in a column on the session's clock; -1: not recorded.
std::int64_t on_the_clock(std::int64_t start_ns, const Statement& row, int column) {
  return row.is_null(column) ? -1 : start_ns + row.integer(0) + row.integer(column);
}

FrameTimes times_of(const PlayedTrial& played, TimingGrade grade, std::int64_t shown) {
  const auto recorded = static_cast<std::int64_t>(played.frames.size());
  if (recorded == 0) return {{}, {}, "no frame is recorded"};
  if (recorded != shown)
    return {{}, {}, std::to_string(recorded) + " of " + std::to_string(shown) + " frames are recorded"};
  const auto each = [&](const auto& has_time) {
    return std::all_of(played.frames.begin(), played.frames.end(), has_time);
  };
  const bool reported = grade == TimingGrade::Photodiode || grade == TimingGrade::DisplayFeedback;
  const auto is_placed = [&](const FrameRecord& one) { return placed_ns(one.times, grade) >= 0; };
  const auto is_shown = [&](const FrameRecord& one) { return one.times.actual_display_ns >= 0; };
  if (!each(is_placed) && !(reported && each(is_shown)))
    return {{}, {}, "the time of a frame is not recorded"};
  FrameTimes out{realised_intervals(played, grade), {}, ""};
  // Imported frames may lack the end of the last one.
  if (played.end_ns < 0) out.intervals_s.pop_back();
  if (out.intervals_s.empty()) return {{}, {}, "a single frame without its end is recorded"};
  if (*std::min_element(out.intervals_s.begin(), out.intervals_s.end()) > 0) return out;
  return {{}, {}, "the onsets do not ascend"};
}

}  // namespace

std::map<std::pair<std::string, int>, FrameTimes> read_frame_times(const StudyFile& file,
                                                                   const std::string& protocol_sha256) {
  const auto database = open_study(file).database;
  std::map<std::pair<std::string, int>, FrameTimes> out;
  Statement showing(*database, shown_first_sql), frame(*database, frame_onsets_sql);
  for (showing.bind_all(protocol_sha256); showing.step();) {
    PlayedTrial played;
    const std::int64_t start_ns = showing.integer(4);
    played.end_ns = showing.integer(5);
    frame.reset();
    for (frame.bind_all(showing.integer(2)); frame.step();) {
      FrameRecord& one = played.frames.emplace_back();
      one.times.submitted_ns = on_the_clock(start_ns, frame, 1);
      one.times.predicted_display_ns = on_the_clock(start_ns, frame, 2);
      one.times.actual_display_ns = on_the_clock(start_ns, frame, 3);
    }
    FrameTimes& times = out[{showing.text(0), static_cast<int>(showing.integer(1))}];
    times = times_of(played, grade_of(showing.text(3)), showing.integer(6));
    if (!showing.is_null(7)) times.animation_error_ms = showing.real(7);
  }
  return out;
}

}  // namespace study
