#pragma once
/// Where a page stands in a headset's world, how large it is to the eye, and where a ray meets it.

#include <optional>
#include <utility>

#include "apps/common/headset/headset_session.hpp"

namespace apps {

/// Of the picture, px.
inline constexpr int page_width_px = 1280, page_height_px = 1120;
/// From the eye when it comes, m; and how wide it is to the eye then, degrees.
inline constexpr double page_distance_m = 1.5, page_width_deg = 38;
/// Height of the letter x of body text, wherever it stands on the page, degrees.
inline constexpr double least_x_height_deg = 0.5;

/// Px that something upright must have to be so high to the eye even in a page's corner.
float px_of_height(double degrees);

/// Upright and level with the head, in the direction in which it looks.
HeadsetPage place_page(const HeadsetPose& head);

/// Whether the head has turned or gone away from a page so far that it should come after.
bool is_left_behind(const HeadsetPage& page, const HeadsetPose& head);

/// Px from the upper left corner of the picture, where a ray along direction_of() meets the page's front.
/// Empty: it does not.
std::optional<std::pair<float, float>> meet_page(const HeadsetPage& page, const HeadsetPose& ray);

}  // namespace apps
