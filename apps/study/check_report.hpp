#pragma once
/// The result of `vip-study check`, as text and as JSON.

#include <optional>
#include <vector>

#include "apps/study/check/measured_check.hpp"
#include "apps/study/check/refresh_check.hpp"
#include "apps/study/check/session_outline.hpp"
#include "apps/study/session_framing.hpp"
#include "stats/base/json.hpp"

namespace apps {

struct CheckReport {
  study::Protocol protocol;
  SessionOutline outline;
  Balance balance;
  std::vector<CheckedSetting> settings;  ///< none under TimingSource::Native
  std::optional<RefreshCheck> refresh;   ///< at the display's own rate, if given
  std::vector<RefreshCheck> common;      ///< at the common rates, if they were checked
  std::optional<MeasuredReport> measured;
  std::vector<FramedScene> scenes;
};

/// The protocol's words for its mean and its timing source.
const char* mean_name(const study::Protocol& protocol);
const char* timing_name(const study::Design& design);
/// Overrun bound of all showings, which are equally long, s.
double overrun_s(const study::Protocol& protocol);
/// Play speeds of the slowest and the fastest setting.
Span play_speeds(const CheckReport& report);

void print_report(const CheckReport& report);
base::Json report_json(const CheckReport& report);

}  // namespace apps
