#pragma once
/// Masks of the pixels that a metric of Table 1 compares. Masks have one byte per pixel, 1 or 0, row 0 at the
/// top.

#include <cstdint>
#include <span>
#include <vector>

#include "libsim/saliency/looks.hpp"
#include "libsim/view/gbuffer.hpp"

namespace measure {

using Mask = std::vector<std::uint8_t>;

/// Smallest mask, px, over which a metric is computed; over a smaller mask its value is NaN.
inline constexpr std::size_t least_mask_pixels = 1000;

std::size_t pixels_of(const Mask& mask);

/// Pixels whose ray lies within `half_angle_deg` of the gaze, as seen from the view's eye.
Mask fovea_mask(const sim::View& view, const sim::Gaze& gaze, double half_angle_deg);

/// The most salient fifth of the fluid's pixels, minus the pixels of `without`. A pixel's value is the
/// combined feature F (Eq. 1) of its front particle, by_id[ids[front]]. The saliency s would not rank the
/// pixels, because many particles have s = 1. Non-finite values count as 0; ties with the last pixel of the
/// fifth are included.
Mask salient_mask(const sim::GBuffer& picture, std::span<const int> ids, std::span<const float> by_id,
                  const Mask& without);

/// Pixels within 3 px, along both axes, of a pixel of either mask.
Mask grown_union(const Mask& a, const Mask& b, int width, int height);

}  // namespace measure
