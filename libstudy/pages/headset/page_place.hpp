#pragma once
/// Position of a page in a headset's world, its visual size, and the point at which a ray hits it.

#include <optional>
#include <utility>

#include "libstudy/headset/headset_session.hpp"

namespace study {

/// Size of a page's picture, px.
inline constexpr int page_width_px = 1280, page_height_px = 1120;
/// Distance of a page from the head when the page appears, m, and its visual width at this distance, degrees.
inline constexpr double page_distance_m = 1.5, page_width_deg = 38;
/// Smallest visual height of the letter x of body text, anywhere on the page, degrees.
inline constexpr double least_x_height_deg = 0.5;

/// The height, px, that subtends at least this visual angle anywhere on the page, even in a corner.
float px_of_height(double degrees);

/// Places a page upright at the height of the head, page_distance_m ahead in the head's horizontal direction.
HeadsetPage place_page(const HeadsetPose& head);

/// True if the head turned or moved so far from a page that the page must be placed anew.
bool is_left_behind(const HeadsetPage& page, const HeadsetPose& head);

/// The point at which a ray from ray.place_m along direction_of(ray) hits the front of the page, px from the
/// upper left corner of the page's picture. None if the ray misses the page.
std::optional<std::pair<float, float>> meet_page(const HeadsetPage& page, const HeadsetPose& ray);

}  // namespace study
