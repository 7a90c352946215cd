#include "stats/image/psnr.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

namespace stats {

ImageScore mean_squared_error(const ImageView& a, const ImageView& b, MaskView mask) {
  check_images(a, b, mask);
  std::uint64_t sum = 0;
  std::size_t pixels = 0;
#pragma omp parallel for schedule(static) reduction(+ : sum, pixels)
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    ++pixels;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
      const int difference = int{a.rgb[c]} - int{b.rgb[c]};
      sum += static_cast<std::uint64_t>(difference * difference);
    }
  }
  const double mean = pixels ? static_cast<double>(sum) / (3.0 * static_cast<double>(pixels))
                             : std::numeric_limits<double>::quiet_NaN();
  return {mean, pixels};
}

ImageScore psnr_db(const ImageView& a, const ImageView& b, MaskView mask) {
  ImageScore out = mean_squared_error(a, b, mask);
  if (out.value == 0) {
    out.value = std::numeric_limits<double>::infinity();
  } else {
    out.value = 10 * std::log10(255.0 * 255.0 / out.value);
  }
  return out;
}

}  // namespace stats
