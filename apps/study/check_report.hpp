#pragma once
/// The result of `vip-study check`, as text and as JSON.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/check/measured_check.hpp"
#include "libstudy/check/refresh_check.hpp"
#include "libstudy/check/session_outline.hpp"
#include "libstudy/runner/session_framing.hpp"
#include "stats/base/json.hpp"

namespace apps {

struct CheckReport {
  study::Protocol protocol;
  study::SessionOutline outline;
  study::PlannedBalance balance;
  /// All settings of the frame rate; none under timing = "native" (each frame is shown when ready).
  std::vector<study::CheckedSetting> settings;
  std::optional<study::RefreshCheck> refresh;  ///< check at the rate of --refresh; none: no --refresh
  std::vector<study::RefreshCheck> common;     ///< checks at the common rates; may be empty
  std::optional<study::MeasuredReport> measured;
  std::vector<study::FramedScene> scenes;
};

/// Words of protocol files for the kind of mean and for the source of the timing.
const char* mean_name(const study::Protocol& protocol);
const char* timing_name(const study::Design& design);
/// Ids of the questions whose answers vip-stats reports by cell: those that the trials ask, except free text
/// and personal questions.
std::vector<std::string> questions_by_cell(const study::Protocol& protocol);
/// Levels that an adaptive procedure may choose, as indices into the levels of its factor: the levels of all
/// cells but the standard's, with which pairs compare the others.
std::vector<std::size_t> candidate_levels(const study::Design& design);
/// Number of tracks in a session. A track is one run of an adaptive procedure, with its own sequence of
/// levels.
int tracks_of(const study::Design& design);
/// Longest time, s, that a showing may run past its planned end before it is cut; equal for all showings,
/// because all showings of a protocol have the same planned duration.
double overrun_s(const study::Protocol& protocol);
/// Smallest and largest play speed (simulated time / display time) over all settings.
study::Span play_speeds(const CheckReport& report);

void print_report(const CheckReport& report);
base::Json report_json(const CheckReport& report);

}  // namespace apps
