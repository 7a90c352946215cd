#include "libstudy/store/read/light_record.hpp"

#include <algorithm>
#include <map>

#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/open_study.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* lit_sessions_sql =
    "SELECT s.session_id, s.participant, s.visit, s.clock = 'virtual', s.protocol_id, "
    "coalesce(json_extract(iif(json_valid("
    "r.options), r.options, '{}'), '$.light_patch'), 0) FROM session s JOIN run r USING (run_id) "
    "WHERE (?1 = '' OR s.participant = ?1) AND (?2 = 0 OR s.visit = ?2) ORDER BY s.session_id";

// The last column numbers the starts of the program that showed the session.
constexpr const char* lit_showings_sql =
    "SELECT p.presentation_id, t.position, p.attempt, p.interval, coalesce(p.grade, ''), p.start_ns, "
    "(SELECT count(*) FROM event e WHERE e.session_id = t.session_id AND e.kind = 'resumed' AND e.event_id < "
    "(SELECT min(b.event_id) FROM event b WHERE b.presentation_id = p.presentation_id)) "
    "FROM presentation p JOIN trial t USING (trial_id) WHERE t.session_id = ? AND p.state = 'played' "
    "AND p.start_ns IS NOT NULL ORDER BY p.presentation_id";

constexpr const char* lit_frames_sql =
    "SELECT scheduled_ns, submitted_ns, predicted_display_ns, actual_display_ns FROM frame WHERE "
    "presentation_id = ? ORDER BY frame_index";

/// The onsets of a showing by the evidence of its record; empty if a frame has none, or they do not ascend.
std::vector<std::int64_t> lit_onsets(Statement& frame, std::int64_t presentation, std::int64_t start_ns,
                                     TimingGrade grade) {
  std::vector<std::int64_t> onsets;
  frame.reset();
  for (frame.bind_all(presentation); frame.step();) {
    const auto time = [&](int column) {
      return frame.is_null(column) ? -1 : start_ns + frame.integer(0) + frame.integer(column);
    };
    const PresentTimes times{time(1), -1, time(2), time(3)};
    const bool displayed = grade == TimingGrade::DisplayFeedback && times.actual_display_ns >= 0;
    const std::int64_t onset = displayed ? times.actual_display_ns : placed_ns(times, grade);
    if (onset < 0 || (!onsets.empty() && onset <= onsets.back())) return {};
    onsets.push_back(onset);
  }
  return onsets;
}

std::vector<std::int64_t> markers_of(Connection& database, std::int64_t session) {
  Statement row(database,
                "SELECT clock_ns + latency_ns FROM marker WHERE session_id = ? AND latency_ns IS NOT NULL "
                "ORDER BY 1");
  std::vector<std::int64_t> markers;
  for (row.bind_all(session); row.step();) markers.push_back(row.integer(0));
  return markers;
}

}  // namespace

std::vector<LitStretch> read_light_record(const StudyFile& study, const std::string& participant, int visit) {
  const auto database = open_study(study).database;
  Statement session(*database, lit_sessions_sql), showing(*database, lit_showings_sql),
      frame(*database, lit_frames_sql);
  std::vector<LitStretch> out;
  bool known = false;
  for (session.bind_all(participant, visit); session.step();) {
    known = true;
    LitStretch common;
    common.session = session.integer(0);
    common.participant = session.text(1);
    common.visit = static_cast<int>(session.integer(2));
    common.virtual_clock = session.integer(3) != 0;
    common.protocol = session.integer(4);
    common.patch = session.integer(5) != 0;
    std::map<std::int64_t, LitStretch> stretches;
    showing.reset();
    for (showing.bind_all(common.session); common.patch && !common.virtual_clock && showing.step();) {
      LitShowing one;
      one.shown.presentation = showing.integer(0);
      one.position = static_cast<int>(showing.integer(1));
      one.attempt = static_cast<int>(showing.integer(2));
      one.interval = static_cast<int>(showing.integer(3));
      one.grade = showing.text(4);
      one.shown.onsets_ns =
          lit_onsets(frame, one.shown.presentation, showing.integer(5), grade_of(one.grade));
      if (one.shown.onsets_ns.size() < 2) continue;
      stretches.try_emplace(showing.integer(6), common).first->second.showings.push_back(std::move(one));
    }
    for (auto& [start, stretch] : stretches) {
      stretch.markers_ns = markers_of(*database, common.session);
      std::sort(stretch.showings.begin(), stretch.showings.end(), [](const auto& a, const auto& b) {
        return a.shown.onsets_ns.front() < b.shown.onsets_ns.front();
      });
      out.push_back(std::move(stretch));
    }
    if (stretches.empty()) out.push_back(std::move(common));
  }
  if (!known)
    throw base::Error(study.path.string(),
                      "has no session of " + (participant.empty() ? "anybody" : base::shortened(participant)),
                      "vip-study status --db " + study.path.string() + " lists the participants");
  return out;
}

}  // namespace study
