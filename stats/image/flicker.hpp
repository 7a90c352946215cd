#pragma once
/// Flicker: changes from frame to frame that differ between a film and its reference.

#include "stats/image/image.hpp"

namespace stats {

/// Two successive pictures of one film.
struct FrameStep {
  ImageView before, now;
};

/// Mean of the squared difference between both films' changes, ((now - before) of a) - ((now - before) of b),
/// over all three channels, in units of one step of the 8-bit encoding. A difference between the films that
/// stays the same from frame to frame does not count.
ImageScore flicker(const FrameStep& a, const FrameStep& b, MaskView mask = {});

}  // namespace stats
