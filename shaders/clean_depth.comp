// Narrow-range filter over a small two-dimensional window. Removes the streaks that the separable filter leaves
// (filter_depth.comp).
#include "view.glsl"
#include "wet_tiles.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Source { float source[]; };
layout(std430, binding = 2) readonly buffer Radius { float radii[]; };
layout(std430, binding = 3) writeonly buffer Target { float target[]; };
#include "narrow_range.glsl"

// Offsets of half the samples of a window of 5 x 5 px, nearest first; the other half are their mirror images.
const ivec2 half_window[12] =
    ivec2[](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(-1, 1), ivec2(2, 0), ivec2(0, 2), ivec2(2, 1),
            ivec2(-2, 1), ivec2(1, 2), ivec2(-1, 2), ivec2(2, 2), ivec2(-2, 2));

void main() {
  const ivec2 pixel = wet_pixel();
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const int at = pixel.y * size.x + pixel.x;
  const float centre = source[at];
  const float radius = radii[at];
  if (radius == 0.0) {
    target[at] = centre;
    return;
  }
  // At most half the particle's radius in px, so that droplets of a few px keep their shape.
  const float sigma = min(1.5, 0.5 * radius * centre / rays.x);
  const float falloff = -0.72134752 / max(sigma * sigma, 1e-6);
  const ivec2 room = min(pixel, size.xy - 1 - pixel);
  Range range = start_range(centre, radius);
  for (int k = 0; k < 12; ++k) {
    const ivec2 away = half_window[k];
    if (any(greaterThan(abs(away), room))) continue;
    const int jump = away.y * size.x + away.x;
    add_pair(range, source[at - jump], source[at + jump], exp2(falloff * float(away.x * away.x + away.y * away.y)));
  }
  float nearness = filtered(range);
  if (tank.w > 0.0) {
    // Keeps the smoothed depth inside the tank.
    const vec2 within = tank_range(slope_at(vec2(pixel) + 0.5));
    if (within.x < within.y) nearness = clamp(nearness, 1.0 / within.y, 1.0 / max(within.x, origin.z));
  }
  target[at] = nearness;
}
