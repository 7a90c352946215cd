#pragma once
/// What displays with a fixed refresh make of a protocol: the data behind `vip-study check`.

#include <functional>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// A protocol on one refresh rate.
struct RefreshCheck {
  double refresh_hz = 0;
  std::vector<study::RefreshVerdict> verdicts;  ///< one for each setting of the protocol, in its order
  int exact = 0, approximate = 0, unreachable = 0;
  double distance = 0;  ///< mean distance to the unquantised rates over the reachable settings, frames/s
};

RefreshCheck check_refresh(const study::Protocol& protocol, double refresh_hz);

/// Refresh rates that displays and headsets commonly have, Hz.
inline const std::vector<double> common_refreshes{60, 72, 80, 90, 100, 120, 144, 165, 200, 240, 360};

/// The rate that serves the protocol best: most exact settings, then fewest unreachable ones, then the least
/// distance. `checks` must not be empty.
const RefreshCheck& best_refresh(const std::vector<RefreshCheck>& checks);

/// Seconds that the plan takes: trials and gaps alone, and with `answer_s` for each answer.
double plan_seconds(const study::Protocol& protocol, double answer_s);

/// Play speed of a setting as a part of real time: mean x content_step_s, or 1 with real_time content.
double play_speed(const study::Protocol& protocol, const study::FpsSetting& setting);

}  // namespace apps
