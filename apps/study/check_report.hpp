#pragma once
/// What `vip-study check` found, for people and as JSON.

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
  std::optional<RefreshCheck> refresh;   ///< on the display's own rate, when it was given
  std::vector<RefreshCheck> common;      ///< on the common ones, where they were looked at
  std::optional<MeasuredReport> measured;
  std::vector<FramedScene> scenes;
};

/// Words of the protocol for its mean, and for where its timing comes from.
const char* mean_name(const study::Protocol& protocol);
const char* timing_name(const study::Design& design);
/// Of all showings: they are equally long.
double overrun_s(const study::Protocol& protocol);
/// From the slowest to the fastest setting.
Span play_speeds(const CheckReport& report);

void print_report(const CheckReport& report);
base::Json report_json(const CheckReport& report);

}  // namespace apps
