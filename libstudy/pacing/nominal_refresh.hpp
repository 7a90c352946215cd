#pragma once
/// The nominal refresh rate of a display. Schedules count holds in periods of this rate.

#include <array>

namespace study {

/// Usual refresh rates of displays and headsets, Hz.
inline constexpr std::array usual_refreshes{50.0,  60.0,  72.0,  75.0,  80.0,  85.0,  90.0,
                                            96.0,  100.0, 120.0, 144.0, 160.0, 165.0, 175.0,
                                            180.0, 200.0, 240.0, 280.0, 300.0, 360.0, 480.0};
/// Two rates within this relative difference count as equal: 59.94 Hz is 60 Hz.
inline constexpr double same_refresh = 0.005;
/// A rate within this relative difference of a whole number of Hz is that number, measured with an error:
/// 88.0000009 Hz is 88 Hz.
inline constexpr double measured_refresh = 1e-4;

/// The nominal rate of a display with the measured rate `hz`, Hz, for vip-study check, run and headset.
/// reported_hz: the rate that the system reports; 0: none. The base is reported_hz if it is within 0.5 % of
/// hz, else hz. Returns the usual rate nearest to the base among the usual rates within 0.5 % of both hz and
/// the base. If there is no such rate, returns the whole number of Hz within 100 ppm of the base, else the
/// base. Schedules count holds in periods of the nominal rate, but a period of the display lasts 1 / true
/// rate. A trial's frame rates then differ from its setting by the ratio of the true rate to the nominal
/// rate; the timing verdict detects this.
double nominal_refresh(double hz, double reported_hz = 0);

}  // namespace study
