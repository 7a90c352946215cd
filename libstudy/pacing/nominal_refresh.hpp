#pragma once
/// The nominal refresh rate of a display, by which schedules count periods.

#include <array>

namespace study {

/// Usual refresh rates of displays and headsets, Hz.
inline constexpr std::array usual_refreshes{50.0,  60.0,  72.0,  75.0,  80.0,  85.0,  90.0,
                                            96.0,  100.0, 120.0, 144.0, 160.0, 165.0, 175.0,
                                            180.0, 200.0, 240.0, 280.0, 300.0, 360.0, 480.0};
/// Two rates within this relative difference count as equal: 59.94 Hz is 60 Hz.
inline constexpr double same_refresh = 0.005;

/// The nominal rate of a display of `hz`, the same for vip-study check, run and headset: the nearest usual
/// rate within 0.5 %. If there is none, the rate that the system reports (reported_hz; 0: none) if within 0.5
/// %, else hz itself. Holds are counted in periods of this rate but last periods of the true rate. A trial's
/// rates so differ from its setting by the same ratio, which the timing verdict detects.
double nominal_refresh(double hz, double reported_hz = 0);

}  // namespace study
