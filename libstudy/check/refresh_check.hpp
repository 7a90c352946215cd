#pragma once
/// Checks how exactly displays with a fixed refresh show the frame rates of a protocol, for `vip-study
/// check`.

#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"

namespace study {

/// A setting of the frame rate, with the cells that use it.
struct CheckedSetting {
  FpsSetting setting;
  std::vector<int> cells;  ///< indices into Design::cells, ascending
};

/// The distinct settings of a protocol, in the order of their first cells; none under TimingSource::Native,
/// which shows each frame when it is ready.
std::vector<CheckedSetting> checked_settings(const Protocol& protocol);

/// The result of check_refresh(): how well a display with one refresh rate shows a protocol's settings.
struct RefreshCheck {
  double asked_hz = 0;                   ///< refresh rate given by the user
  double refresh_hz = 0;                 ///< refresh rate used for schedules: nominal_refresh(asked_hz)
  std::vector<RefreshVerdict> verdicts;  ///< one per setting, in the order of checked_settings()
  int exact = 0, approximate = 0, unreachable = 0;
  /// Mean RefreshVerdict::distance (from the requested rates to the shown rates) of the reachable settings,
  /// frames/s; 0 if no setting is reachable.
  double distance = 0;
};

/// The frame intervals of `setting`, ns, from its verdict in `check`; empty if the setting is not among
/// `settings` or has no schedule at this refresh rate. `settings`: checked_settings() of the protocol.
std::vector<std::int64_t> intervals_on(const RefreshCheck& check, const std::vector<CheckedSetting>& settings,
                                       const FpsSetting& setting);

RefreshCheck check_refresh(const Protocol& protocol, double refresh_hz);

/// Common refresh rates of displays and headsets, Hz.
inline const std::vector<double> common_refreshes{60, 72, 80, 90, 100, 120, 144, 165, 200, 240, 360};

/// The check with the best refresh rate: with the most exact settings; among equals, with the fewest
/// unreachable settings; then with the smallest distance. `checks` must not be empty.
const RefreshCheck& best_refresh(const std::vector<RefreshCheck>& checks);

/// Play speed of the fluid under a setting, relative to real time: mean frame rate x content_step_s, or 1 if
/// the content plays in real time.
double play_speed(const Protocol& protocol, const FpsSetting& setting);

}  // namespace study
