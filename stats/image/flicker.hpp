#pragma once
/// Changes from frame to frame that a film has and its reference has not.

#include "stats/image/image.hpp"

namespace stats {

/// Two pictures of one film, one frame apart.
struct FrameStep {
  ImageView before, now;
};

/// Mean of the squared difference between both films' changes, ((now - before) of a) - ((now - before) of b),
/// over all three channels, in units of one step of the 8-bit encoding. An error that stays is no flicker.
ImageScore flicker(const FrameStep& a, const FrameStep& b, MaskView mask = {});

}  // namespace stats
