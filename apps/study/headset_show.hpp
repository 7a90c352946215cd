#pragma once
/// `vip-study headset --show`: shows a test scene in the headset and reports what happened.

namespace apps {

struct ShowChoice {
  double seconds = 0;      ///< duration in predicted display time, from the first frame
  double patience_s = 10;  ///< longest time for which the runtime may block a frame, s
  double refresh_hz = 0;   ///< requested refresh rate, Hz; 0: unchanged
};

/// Shows the scene and prints the report. base::Error if there is no headset or if the headset fails during
/// the scene; the report up to the failure is then printed too.
void show_in_headset(const ShowChoice& choice);

}  // namespace apps
