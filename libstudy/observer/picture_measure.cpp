#include "libstudy/observer/picture_measure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace study {

namespace {

constexpr int window_radius_px = 15;
constexpr std::size_t least_pixels = 100;

/// Summed-area table: gives the sum of a value over any rectangle of pixels in constant time.
class SumTable {
 public:
  template <class Value>
  SumTable(int width, int height, const Value& value)
      : stride_(static_cast<std::size_t>(width) + 1),
        sums_(stride_ * (static_cast<std::size_t>(height) + 1)) {
    for (int y = 0; y < height; ++y) {
      double row = 0;
      for (int x = 0; x < width; ++x) {
        row += value(x, y);
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }
  /// Sum over the columns x0 .. x1 - 1 and the rows y0 .. y1 - 1.
  double sum(int x0, int y0, int x1, int y1) const {
    return sums_[at(x1, y1)] - sums_[at(x0, y1)] - sums_[at(x1, y0)] + sums_[at(x0, y0)];
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
  }
  std::size_t stride_;
  std::vector<double> sums_;
};

std::size_t index_of(const MeasuredPicture& picture, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
}

/// Luminance of each pixel minus the mean over the fluid's pixels in a window around it; 0 outside the fluid.
std::vector<double> residual(const MeasuredPicture& picture) {
  const auto is_fluid = [&](int x, int y) { return picture.fluid[index_of(picture, x, y)]; };
  const SumTable count(picture.width, picture.height,
                       [&](int x, int y) { return is_fluid(x, y) ? 1.0 : 0.0; });
  const SumTable light(picture.width, picture.height, [&](int x, int y) {
    return is_fluid(x, y) ? static_cast<double>(picture.luminance[index_of(picture, x, y)]) : 0.0;
  });
  std::vector<double> out(picture.luminance.size());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (!is_fluid(x, y)) continue;
      const int x0 = std::max(0, x - window_radius_px),
                x1 = std::min(picture.width, x + window_radius_px + 1);
      const int y0 = std::max(0, y - window_radius_px),
                y1 = std::min(picture.height, y + window_radius_px + 1);
      const std::size_t i = index_of(picture, x, y);
      out[i] =
          static_cast<double>(picture.luminance[i]) - light.sum(x0, y0, x1, y1) / count.sum(x0, y0, x1, y1);
    }
  }
  return out;
}

/// Mask of the quarter of the fluid's pixels that is nearest to the gaze point.
std::vector<std::uint8_t> near_gaze(const MeasuredPicture& picture, double gaze_x, double gaze_y) {
  std::vector<std::pair<double, std::size_t>> distances;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t i = index_of(picture, x, y);
      if (picture.fluid[i]) distances.emplace_back(std::hypot(x - gaze_x, y - gaze_y), i);
    }
  }
  std::vector<std::uint8_t> out(picture.fluid.size());
  const auto quarter = static_cast<std::ptrdiff_t>(distances.size() / 4);
  std::nth_element(distances.begin(), distances.begin() + quarter, distances.end());
  for (std::ptrdiff_t k = 0; k < quarter; ++k) out[distances[static_cast<std::size_t>(k)].second] = 1;
  return out;
}

double granularity(const MeasuredPicture& picture, double gaze_x, double gaze_y) {
  const auto r = residual(picture);
  const auto chosen = near_gaze(picture, gaze_x, gaze_y);
  double square = 0, slope = 0, count = 0;
  for (int y = 0; y + 1 < picture.height; ++y) {
    for (int x = 0; x + 1 < picture.width; ++x) {
      const std::size_t i = index_of(picture, x, y), right = i + 1, next = index_of(picture, x, y + 1);
      if (!chosen[i] || !picture.fluid[right] || !picture.fluid[next]) continue;
      square += r[i] * r[i];
      slope += (r[right] - r[i]) * (r[right] - r[i]) + (r[next] - r[i]) * (r[next] - r[i]);
      ++count;
    }
  }
  return count > 0 && slope > 0 ? 2 * std::numbers::pi * std::sqrt(square / slope) : 0;
}

}  // namespace

PictureFeatures measure_pictures(const std::array<MeasuredPicture, 3>& pictures, double x_px, double y_px) {
  const MeasuredPicture& middle = pictures[1];
  double change = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < middle.fluid.size(); ++i) {
    if (!pictures[0].fluid[i] || !middle.fluid[i] || !pictures[2].fluid[i]) continue;
    const auto light = [&](int k) {
      return static_cast<double>(pictures[static_cast<std::size_t>(k)].luminance[i]);
    };
    change += std::abs(light(0) - 2 * light(1) + light(2));
    ++count;
  }
  if (count < least_pixels) return {};
  return {granularity(middle, x_px, y_px), change / static_cast<double>(count)};
}

}  // namespace study
