#include "libstudy/pages/headset/page_place.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace study {

namespace {

constexpr double degree = std::numbers::pi / 180;
// A page is placed anew once the head points more than farthest_deg away from the page's middle, or once the
// distance of head and page differs from page_distance_m by more than farthest_m.
constexpr double farthest_deg = 50, farthest_m = 0.8;

const double width_m = 2 * page_distance_m * std::tan(0.5 * page_width_deg * degree);
const double height_m = width_m * page_height_px / page_width_px;

using Vector = std::array<float, 3>;
float dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector difference(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

}  // namespace

float px_of_height(double degrees) {
  // Lengths here are in units of page_distance_m. (x, y): corner of the page, where an upright length
  // subtends the smallest visual angle. slope: visual angle, rad, of an upright unit length in the corner.
  // px: length of a pixel.
  const double x = 0.5 * width_m / page_distance_m, y = 0.5 * height_m / page_distance_m;
  const double slope = std::sqrt(1 + x * x) / (1 + x * x + y * y);
  const double px = width_m / page_distance_m / page_width_px;
  return static_cast<float>(degrees * degree / slope / px);
}

HeadsetPage place_page(const HeadsetPose& head) {
  const Vector ahead = direction_of(head);
  const float yaw = std::atan2(-ahead[0], -ahead[2]);
  const auto distance = static_cast<float>(page_distance_m);
  HeadsetPage page;
  page.pose = head;
  page.pose.place_m[0] -= distance * std::sin(yaw);
  page.pose.place_m[2] -= distance * std::cos(yaw);
  page.pose.turn = {0, std::sin(yaw / 2), 0, std::cos(yaw / 2)};
  page.width_m = static_cast<float>(width_m);
  page.height_m = static_cast<float>(height_m);
  return page;
}

bool is_left_behind(const HeadsetPage& page, const HeadsetPose& head) {
  const Vector way = difference(page.pose.place_m, head.place_m);
  const float distance = std::sqrt(dot(way, way));
  if (std::abs(distance - static_cast<float>(page_distance_m)) > static_cast<float>(farthest_m)) return true;
  return dot(way, direction_of(head)) < distance * static_cast<float>(std::cos(farthest_deg * degree));
}

std::optional<std::pair<float, float>> meet_page(const HeadsetPage& page, const HeadsetPose& ray) {
  const auto axes = axes_of(page.pose);
  const Vector right{axes[0], axes[1], axes[2]}, up{axes[3], axes[4], axes[5]},
      front{axes[6], axes[7], axes[8]};
  const Vector along = direction_of(ray);
  const float towards = -dot(along, front);
  if (towards <= 1e-6F) return {};
  const Vector from = difference(ray.place_m, page.pose.place_m);
  const float length = dot(from, front) / towards;
  if (length <= 0) return {};
  const Vector at{from[0] + length * along[0], from[1] + length * along[1], from[2] + length * along[2]};
  const float u = 0.5F + dot(at, right) / page.width_m, v = 0.5F - dot(at, up) / page.height_m;
  if (u < 0 || v < 0 || u >= 1 || v >= 1) return {};
  return std::pair{u * page_width_px, v * page_height_px};
}

}  // namespace study
