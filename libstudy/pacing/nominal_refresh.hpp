#pragma once
/// The refresh rate that schedules are counted by on a display.

#include <array>

namespace study {

/// Refresh rates that displays and headsets have, Hz.
inline constexpr std::array usual_refreshes{50.0,  60.0,  72.0,  75.0,  80.0,  85.0,  90.0,
                                            96.0,  100.0, 120.0, 144.0, 160.0, 165.0, 175.0,
                                            180.0, 200.0, 240.0, 280.0, 300.0, 360.0, 480.0};
/// A rate is another one within this share of it: 59.94 Hz is 60 Hz.
inline constexpr double same_refresh = 0.005;

/// What a display of `hz` counts as, for vip-study check, run and headset alike: the nearest usual rate
/// within 0.5 %. Without one, the rate that the system tells (told_hz; 0: none) where that is within 0.5 %,
/// else hz itself. Holds are counted in periods of this rate and last periods of the true one, so that a
/// trial differs from its setting by the same share, and the verdict on its timing sees that.
double nominal_refresh(double hz, double told_hz = 0);

}  // namespace study
