#pragma once
/// What displays with a fixed refresh make of a protocol: the data behind `vip-study check`.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// A setting of the frame rate, and the cells that have it.
struct CheckedSetting {
  study::FpsSetting setting;
  std::vector<int> cells;  ///< indices into Design::cells, ascending
};

/// The different settings of a protocol in the order of its cells; none under TimingSource::Native.
std::vector<CheckedSetting> checked_settings(const study::Protocol& protocol);

/// A protocol on one refresh rate.
struct RefreshCheck {
  double asked_hz = 0;                          ///< as it was given
  double refresh_hz = 0;                        ///< that schedules are counted by: study::nominal_refresh
  std::vector<study::RefreshVerdict> verdicts;  ///< one for each of checked_settings()
  int exact = 0, approximate = 0, unreachable = 0;
  double distance = 0;  ///< mean distance to the unquantised rates over the reachable settings, frames/s
};

/// The schedule of one of these settings by its verdict, nanoseconds; empty where it has none.
std::vector<std::int64_t> intervals_on(const RefreshCheck& check, const std::vector<CheckedSetting>& settings,
                                       const study::FpsSetting& setting);

RefreshCheck check_refresh(const study::Protocol& protocol, double refresh_hz);

/// Refresh rates that displays and headsets commonly have, Hz.
inline const std::vector<double> common_refreshes{60, 72, 80, 90, 100, 120, 144, 165, 200, 240, 360};

/// The rate that serves the protocol best: most exact settings, then fewest unreachable ones, then the least
/// distance. `checks` must not be empty.
const RefreshCheck& best_refresh(const std::vector<RefreshCheck>& checks);

/// Play speed of a setting as a part of real time: mean x content_step_s, or 1 with real_time content.
double play_speed(const study::Protocol& protocol, const study::FpsSetting& setting);

}  // namespace apps
