#include "stats/image/image.hpp"

#include <stdexcept>

namespace stats {

void check_images(const ImageView& a, const ImageView& b, MaskView mask) {
  if (a.width <= 0 || a.height <= 0 || a.width != b.width || a.height != b.height)
    throw std::invalid_argument(
        "image metric: the pictures differ in size or are empty; give two pictures of one size above 0 x 0");
  if (a.rgb.size() != 3 * a.pixels() || b.rgb.size() != 3 * a.pixels())
    throw std::invalid_argument(
        "image metric: a picture's bytes do not fit its size; give width x height x 3 bytes");
  if (!mask.empty() && mask.size() != a.pixels())
    throw std::invalid_argument(
        "image metric: the mask does not fit the pictures; give width x height bytes, or none for the whole "
        "picture");
}

}  // namespace stats
