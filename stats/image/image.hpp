#pragma once
/// Pictures and masks for the image metrics.

#include <cstddef>
#include <cstdint>
#include <span>

namespace stats {

/// Rows of pixels, three bytes each: red, green, blue, encoded for sRGB displays. The caller owns the bytes.
struct ImageView {
  int width = 0, height = 0;
  std::span<const std::uint8_t> rgb;  ///< width x height x 3

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// One byte per pixel; nonzero pixels belong to the mask. An empty mask means the whole picture.
using MaskView = std::span<const std::uint8_t>;

/// A metric over the pixels of a mask.
struct ImageScore {
  double value = 0;        ///< NaN if `pixels` is 0
  std::size_t pixels = 0;  ///< number of pixels in the mask for which the metric is defined
};

/// Throws std::invalid_argument unless both pictures have the same positive size and all spans fit it.
void check_images(const ImageView& a, const ImageView& b, MaskView mask);

}  // namespace stats
