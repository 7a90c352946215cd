#pragma once
/// `vip-study headset --show`: a test scene in the headset, and what happened meanwhile.

namespace apps {

struct ShowChoice {
  double seconds = 0;      ///< of predicted time, from the first frame
  double patience_s = 10;  ///< for a runtime that holds a frame
  double refresh_hz = 0;   ///< asked for; 0: as it is
};

/// Shows the scene and prints the report. base::Error when there is no headset, or it fails on the way; the
/// report is printed then too, as far as it goes.
void show_in_headset(const ShowChoice& choice);

}  // namespace apps
