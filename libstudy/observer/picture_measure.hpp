#pragma once
/// Computes study::PictureFeatures from pictures.

#include <array>
#include <cstdint>
#include <vector>

#include "libstudy/observer/picture_features.hpp"

namespace study {

/// Luminance in [0, 1] and a mask of the fluid's pixels. Both have width x height values, in any row order.
struct MeasuredPicture {
  int width = 0, height = 0;
  std::vector<float> luminance;
  std::vector<std::uint8_t> fluid;  ///< 1: the pixel shows fluid; 0: it does not
};

/// Features of three successive pictures of equal size; granularity is measured in the middle picture. (x_px,
/// y_px) is the gaze point, px, in the row order of the pictures. Both features are 0 if fewer than 100
/// pixels show fluid in all three pictures.
PictureFeatures measure_pictures(const std::array<MeasuredPicture, 3>& pictures, double x_px, double y_px);

}  // namespace study
