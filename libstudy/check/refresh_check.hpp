#pragma once
/// Checks a protocol on displays with a fixed refresh: the data of `vip-study check`.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// A setting of the frame rate, and the cells that have it.
struct CheckedSetting {
  FpsSetting setting;
  std::vector<int> cells;  ///< indices into Design::cells, ascending
};

/// The distinct settings of a protocol in the order of its cells; none under TimingSource::Native.
std::vector<CheckedSetting> checked_settings(const Protocol& protocol);

/// The result of a protocol at one refresh rate.
struct RefreshCheck {
  double asked_hz = 0;                   ///< as it was given
  double refresh_hz = 0;                 ///< nominal rate of the schedules: study::nominal_refresh
  std::vector<RefreshVerdict> verdicts;  ///< one for each of checked_settings()
  int exact = 0, approximate = 0, unreachable = 0;
  double distance = 0;  ///< mean distance to the unquantised rates over the reachable settings, frames/s
};

/// The schedule of one of these settings by its verdict, nanoseconds; empty if it has none.
std::vector<std::int64_t> intervals_on(const RefreshCheck& check, const std::vector<CheckedSetting>& settings,
                                       const FpsSetting& setting);

RefreshCheck check_refresh(const Protocol& protocol, double refresh_hz);

/// Common refresh rates of displays and headsets, Hz.
inline const std::vector<double> common_refreshes{60, 72, 80, 90, 100, 120, 144, 165, 200, 240, 360};

/// The best rate for the protocol: most exact settings, then fewest unreachable ones, then the least
/// distance. `checks` must not be empty.
const RefreshCheck& best_refresh(const std::vector<RefreshCheck>& checks);

/// Play speed of a setting relative to real time: mean x content_step_s, or 1 with real_time content.
double play_speed(const Protocol& protocol, const FpsSetting& setting);

}  // namespace study
