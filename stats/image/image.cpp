#include "stats/image/image.hpp"

#include <stdexcept>

namespace stats {

void check_images(const ImageView& a, const ImageView& b, MaskView mask) {
  if (a.width <= 0 || a.height <= 0 || a.width != b.width || a.height != b.height)
    throw std::invalid_argument("pictures must have the same positive size");
  if (a.rgb.size() != 3 * a.pixels() || b.rgb.size() != 3 * a.pixels())
    throw std::invalid_argument("a picture must hold width x height x 3 bytes");
  if (!mask.empty() && mask.size() != a.pixels())
    throw std::invalid_argument("a mask must hold width x height bytes");
}

}  // namespace stats
