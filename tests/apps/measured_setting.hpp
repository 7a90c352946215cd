#pragma once
/// A setting file with a made-up [measured] part.

#include "libsim/setting/setting_file.hpp"

namespace apps::test {

inline sim::SettingFile measured_setting(const sim::SolverSetting& setting) {
  return {setting,
          {.machine = "a machine",
           .program = "0.1.0 abc",
           .scene_sha256 = "feed",
           .picture = "none",
           .seconds = 2,
           .budget_ms = 11,
           .ms_mean = 8,
           .ms_p95 = 9.75,
           .error = "centre_pct",
           .error_pct = 0.25,
           .error_low_pct = 0.2,
           .error_high_pct = 0.3,
           .seeds = 4,
           .date_utc = "2026-01-31T12:00:00Z"}};
}

}  // namespace apps::test
