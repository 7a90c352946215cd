#pragma once
/// `vip-study headset --show`: shows a test scene in the headset and reports what happened.

namespace apps {

struct ShowChoice {
  double seconds = 0;      ///< of predicted display time, from the first frame
  double patience_s = 10;  ///< longest wait for a runtime that blocks a frame
  double refresh_hz = 0;   ///< requested; 0: unchanged
};

/// Shows the scene and prints the report. base::Error if there is no headset or it fails during the scene;
/// the report so far is printed then too.
void show_in_headset(const ShowChoice& choice);

}  // namespace apps
