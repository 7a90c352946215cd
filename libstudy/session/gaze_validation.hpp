#pragma once
/// A block of kind gaze_validation: nine targets, looked at one after the other.

#include "libstudy/session/running.hpp"

namespace study {

/// Shows the block's nine targets and stores the eye tracker's accuracy and precision at each. Repeats this,
/// up to the block's number of tries, while the mean accuracy is beyond its bound or a target had no valid
/// sample. Without a tracker or permission to record gaze, shows nothing and logs that. base::Error, with all
/// tries stored and the unit open, if the last try fails too.
void validate_gaze(const Running& run, const Block& block, const Check& check);

}  // namespace study
