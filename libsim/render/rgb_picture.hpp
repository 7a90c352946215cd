#pragma once
/// A picture in the format of the image metrics.

#include <cstdint>
#include <vector>

#include "libsim/render/png.hpp"
#include "stats/image/image.hpp"

namespace sim {

/// Row 0 is the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  stats::ImageView view() const { return {width, height, rgb}; }
};
/// The colours of an RGBA picture.
Picture without_alpha(const Image& image);

}  // namespace sim
