#pragma once
/// What `vip-study check` found, for people and as JSON.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "apps/study/check/measured_check.hpp"
#include "apps/study/check/refresh_check.hpp"
#include "apps/study/check/session_outline.hpp"
#include "apps/study/session_framing.hpp"

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

void print_report(const CheckReport& report);
nlohmann::ordered_json report_json(const CheckReport& report);

}  // namespace apps
