#include "stats/image/flicker.hpp"

#include <limits>

namespace stats {

ImageScore flicker(const FrameStep& a, const FrameStep& b, MaskView mask) {
  check_images(a.before, a.now, mask);
  check_images(a.now, b.before, mask);
  check_images(b.before, b.now, mask);
  std::uint64_t sum = 0;
  std::size_t pixels = 0;
#pragma omp parallel for schedule(static) reduction(+ : sum, pixels)
  for (std::size_t i = 0; i < a.now.pixels(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    ++pixels;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
      const int change_a = int{a.now.rgb[c]} - int{a.before.rgb[c]};
      const int change_b = int{b.now.rgb[c]} - int{b.before.rgb[c]};
      const int difference = change_a - change_b;
      sum += static_cast<std::uint64_t>(difference * difference);
    }
  }
  const double mean = pixels ? static_cast<double>(sum) / (3.0 * static_cast<double>(pixels))
                             : std::numeric_limits<double>::quiet_NaN();
  return {mean, pixels};
}

}  // namespace stats
