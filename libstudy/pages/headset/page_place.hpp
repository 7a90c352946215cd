#pragma once
/// Position of a page in a headset's world, its visual size, and its intersection with a ray.

#include <optional>
#include <utility>

#include "libstudy/headset/headset_session.hpp"

namespace study {

/// Size of the picture, px.
inline constexpr int page_width_px = 1280, page_height_px = 1120;
/// Distance of a page from the eye when the page appears, m, and its visual width then, degrees.
inline constexpr double page_distance_m = 1.5, page_width_deg = 38;
/// Least visual height of the letter x of body text anywhere on the page, degrees.
inline constexpr double least_x_height_deg = 0.5;

/// Height in px that subtends at least this visual angle anywhere on the page, even in a corner.
float px_of_height(double degrees);

/// Places a page upright, level with the head, in its direction.
HeadsetPage place_page(const HeadsetPose& head);

/// True if the head turned or moved so far from a page that the page should follow.
bool is_left_behind(const HeadsetPage& page, const HeadsetPose& head);

/// Point where a ray along direction_of() meets the page's front, px from the picture's upper left corner.
/// None if the ray misses the page.
std::optional<std::pair<float, float>> meet_page(const HeadsetPage& page, const HeadsetPose& ray);

}  // namespace study
