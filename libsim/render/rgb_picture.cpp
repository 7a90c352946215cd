#include "libsim/render/rgb_picture.hpp"

namespace sim {

Picture without_alpha(const Image& image) {
  Picture out{image.width, image.height, {}};
  const std::size_t pixels = image.rgba.size() / 4;
  out.rgb.resize(3 * pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * p + c] = image.rgba[4 * p + c];
  }
  return out;
}

}  // namespace sim
