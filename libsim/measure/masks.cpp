#include "libsim/measure/masks.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/render/fluid_picture.hpp"

namespace measure {

namespace {

constexpr double salient_share = 0.2;
constexpr int grown_px = 3;

/// 1 if any of values[(i - 3) step .. (i + 3) step] is 1, along a line of `count` pixels.
void grow_line(const std::uint8_t* in, std::uint8_t* out, int count, std::size_t step) {
  for (int i = 0; i < count; ++i) {
    std::uint8_t any = 0;
    for (int k = std::max(0, i - grown_px); k <= std::min(count - 1, i + grown_px); ++k)
      any |= in[static_cast<std::size_t>(k) * step];
    out[static_cast<std::size_t>(i) * step] = any;
  }
}

}  // namespace

std::size_t pixels_of(const Mask& mask) {
  return static_cast<std::size_t>(std::count_if(mask.begin(), mask.end(), [](auto on) { return on != 0; }));
}

Mask fovea_mask(const sim::View& view, const sim::Gaze& gaze, double half_angle_deg) {
  const int width = view.viewport.width;
  const int height = view.viewport.height;
  Mask out(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const double reach = std::cos(half_angle_deg * 0.017453292519943295);
  const auto& g = gaze.direction;
  const double length = std::hypot(g[0], g[1], g[2]);
#pragma omp parallel for schedule(static)
  for (int row = 0; row < height; ++row) {
    for (int x = 0; x < width; ++x) {
      const auto ray = sim::gaze_through(view, x + 0.5, height - row - 0.5).direction;
      const double along = ray[0] * g[0] + ray[1] * g[1] + ray[2] * g[2];
      const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
      out[at + static_cast<std::size_t>(x)] = along >= reach * length * std::hypot(ray[0], ray[1], ray[2]);
    }
  }
  return out;
}

Mask salient_mask(const sim::GBuffer& picture, std::span<const int> ids, std::span<const float> by_id,
                  const Mask& without) {
  const auto width = static_cast<std::size_t>(picture.width);
  const auto height = static_cast<std::size_t>(picture.height);
  Mask out(width * height, 0);
  constexpr float nothing = -1;  // marks pixels without fluid; F is never negative
  std::vector<float> values(out.size(), nothing);
  std::vector<float> ranked;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const auto front = picture.front[(height - 1 - y) * width + x];
      if (front == sim::GBuffer::no_particle) continue;
      const float f = by_id[static_cast<std::size_t>(ids[front])];
      values[y * width + x] = std::isfinite(f) ? f : 0.0F;
      ranked.push_back(values[y * width + x]);
    }
  }
  const auto wanted = static_cast<std::size_t>(salient_share * static_cast<double>(ranked.size()));
  if (wanted == 0) return out;
  const auto last = ranked.begin() + static_cast<std::ptrdiff_t>(wanted - 1);
  std::nth_element(ranked.begin(), last, ranked.end(), std::greater<>());
  for (std::size_t p = 0; p < out.size(); ++p) out[p] = values[p] >= *last && !without[p];
  return out;
}

Mask grown_union(const Mask& a, const Mask& b, int width, int height) {
  Mask either(a.size());
  for (std::size_t p = 0; p < a.size(); ++p) either[p] = a[p] | b[p];
  Mask rows(a.size());
  const auto stride = static_cast<std::size_t>(width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    grow_line(either.data() + y * stride, rows.data() + y * stride, width, 1);
  Mask out(a.size());
  for (std::size_t x = 0; x < stride; ++x) grow_line(rows.data() + x, out.data() + x, height, stride);
  return out;
}

}  // namespace measure
