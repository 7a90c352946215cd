#pragma once
/// Pixels that a metric of Table 1 uses. Masks have one byte per pixel, 1 or 0, row 0 at the top.

#include <cstdint>
#include <span>
#include <vector>

#include "libsim/view/gbuffer.hpp"
#include "libsim/saliency/looks.hpp"

namespace measure {

using Mask = std::vector<std::uint8_t>;

/// Masks with fewer pixels are left out of the table.
inline constexpr std::size_t least_mask_pixels = 1000;

std::size_t pixels_of(const Mask& mask);

/// Pixels whose ray is within the angle of the gaze, both from the view's eye.
Mask fovea_mask(const sim::View& view, const sim::Gaze& gaze, double half_angle_deg);

/// The most salient fifth of the fluid's pixels, without those of `without`. A pixel's value is the F of the
/// particle in front, by_id[ids[front]]; s saturates at 1 above its range, so only F can rank the particles.
/// Non-finite values are not salient; ties with the last pixel of the fifth are included.
Mask salient_mask(const sim::GBuffer& picture, std::span<const int> ids, std::span<const float> by_id,
                  const Mask& without);

/// Pixels within 3 px, along both axes, of a pixel of either mask.
Mask grown_union(const Mask& a, const Mask& b, int width, int height);

}  // namespace measure
