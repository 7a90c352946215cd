#pragma once
/// The result of `vip-study check`, as text and as JSON.

#include <optional>
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
  std::vector<study::CheckedSetting> settings;  ///< none under TimingSource::Native
  std::optional<study::RefreshCheck> refresh;   ///< at the display's own rate, if given
  std::vector<study::RefreshCheck> common;      ///< at the common rates, if they were checked
  std::optional<study::MeasuredReport> measured;
  std::vector<study::FramedScene> scenes;
};

/// The protocol's words for its mean and its timing source.
const char* mean_name(const study::Protocol& protocol);
const char* timing_name(const study::Design& design);
/// Overrun bound of all showings, which are equally long, s.
double overrun_s(const study::Protocol& protocol);
/// Play speeds of the slowest and the fastest setting.
study::Span play_speeds(const CheckReport& report);

void print_report(const CheckReport& report);
base::Json report_json(const CheckReport& report);

}  // namespace apps
