#pragma once
/// A block of kind gaze_validation: nine targets, looked at one after the other.

#include "libstudy/session/running.hpp"

namespace study {

/// Shows the block's nine targets, keeps how well the eye tracker told each, and does so again, up to the
/// block's number of tries, while the mean accuracy is beyond its bound or a target had no valid sample.
/// Without a tracker, or where the participant does not allow gaze to be recorded, nothing is shown; the log
/// says so. base::Error, with all tries kept and the unit open, when the last try fails too.
void validate_gaze(const Running& run, const Block& block, const Check& check);

}  // namespace study
