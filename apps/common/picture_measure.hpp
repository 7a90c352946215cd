#pragma once
/// study::PictureFeatures of pictures.

#include <array>
#include <cstdint>
#include <vector>

#include "libstudy/observer/picture_features.hpp"

namespace apps {

/// Luminance 0 .. 1 and which pixels show fluid; both of size width x height, any row order.
struct MeasuredPicture {
  int width = 0, height = 0;
  std::vector<float> luminance;
  std::vector<std::uint8_t> fluid;  ///< 1: fluid
};

/// Features of three successive pictures of equal size, the granularity of the middle one; (x, y) is where
/// one looks, px. Both are 0 where too little fluid is seen (fewer than 100 pixels).
study::PictureFeatures measure_pictures(const std::array<MeasuredPicture, 3>& pictures, double x_px,
                                        double y_px);

}  // namespace apps
