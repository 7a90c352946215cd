#pragma once
/// Which pixels a metric of Table 1 looks at. All masks are bytes, 1 or 0 a pixel, row 0 at the top.

#include <cstdint>
#include <span>
#include <vector>

#include "libsim/view/gbuffer.hpp"
#include "libsim/saliency/looks.hpp"

namespace apps {

using Mask = std::vector<std::uint8_t>;

/// Masks with fewer pixels are left out of the table.
inline constexpr std::size_t least_mask_pixels = 1000;

std::size_t pixels_of(const Mask& mask);

/// Pixels whose ray is within the angle of the gaze, both from the view's eye.
Mask fovea_mask(const sim::View& view, const sim::Gaze& gaze, double half_angle_deg);

/// The most salient fifth of the fluid's pixels, less those of `without`. A pixel has the F of the particle
/// in front, by_id[ids[front]]: s rises with F, but is 1 for all above its range, so that F ranks what s
/// cannot. What is not finite is not salient; pixels as salient as the last of the fifth belong to it.
Mask salient_mask(const sim::GBuffer& picture, std::span<const int> ids, std::span<const float> by_id,
                  const Mask& without);

/// Pixels with one of either mask within 3 px along both axes.
Mask grown_union(const Mask& a, const Mask& b, int width, int height);

}  // namespace apps
