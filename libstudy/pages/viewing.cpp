#include "libstudy/pages/viewing.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "stats/base/error.hpp"

namespace study {

namespace {

void check_length(const std::string& what, double mm, double low_mm, double high_mm) {
  if (mm >= low_mm && mm <= high_mm) return;  // false for NaN
  throw base::Error(
      what, std::to_string(mm) + " mm is not a plausible length",
      "measure it in mm, from " + std::to_string(int(low_mm)) + " to " + std::to_string(int(high_mm)));
}

}  // namespace

double picture_height_mm(double picture_width_mm, int width_px, int height_px) {
  check_length("width of the picture", picture_width_mm, 10, 20'000);
  if (width_px < 1 || height_px < 1)
    throw base::Error(
        "picture",
        "of " + std::to_string(width_px) + " x " + std::to_string(height_px) + " pixels has no area",
        "make it at least 1 x 1 pixel");
  return picture_width_mm * height_px / width_px;
}

double vertical_fov_deg(double height_mm, double viewing_distance_mm) {
  check_length("height of the picture", height_mm, 10, 20'000);
  check_length("viewing distance", viewing_distance_mm, 100, 20'000);
  return 2 * std::atan(height_mm / (2 * viewing_distance_mm)) * 180 / std::numbers::pi;
}

}  // namespace study
