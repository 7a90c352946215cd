// One pass of the narrow-range filter (Truong and Yuksel 2018) along x or y. The filter's width is proportional to the
// radius of the front particle at the pixel. A wide filter samples only every n-th pixel; two further passes with
// `dense` = 1 smooth between these samples.
#include "view.glsl"
#include "wet_tiles.glsl"
#include "counters.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Source { float source[]; };
layout(std430, binding = 2) readonly buffer Radius { float radii[]; };
layout(std430, binding = 3) writeonly buffer Target { float target[]; };
uniform ivec2 direction;
uniform int dense;
uniform int counts;  // 1: count the capped pixels, in the first pass of each direction
#include "narrow_range.glsl"

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
  float sigma = narrow_range.x * radius * centre / (direction.x == 1 ? rays.x : rays.z);
  float reach = 3.0 * sigma;
  if (reach > narrow_range.w) {
    if (counts == 1) atomicAdd(filter_capped, 1u);
    reach = narrow_range.w;
  }
  int taps = int(min(ceil(reach), thickness_rule.w));
  float stride = max(reach / float(max(taps, 1)), 1.0);
  if (dense == 1) {
    sigma = 0.75 * (stride - 1.0);
    taps = int(ceil(2.0 * sigma));
    stride = 1.0;
  }
  const float falloff = -0.72134752 / max(sigma * sigma, 1e-6);  // exp2(falloff x^2) = exp(-x^2 / (2 sigma^2))
  // Samples beyond the picture are left out together with their mirror images.
  const int room = direction.x == 1 ? min(pixel.x, size.x - 1 - pixel.x) : min(pixel.y, size.y - 1 - pixel.y);
  const int jump = direction.x == 1 ? 1 : size.x;
  Range range = start_range(centre, radius);
  for (int k = 1; k <= taps; ++k) {
    const int away = int(float(k) * stride + 0.5);
    if (away > room) break;
    add_pair(range, source[at - away * jump], source[at + away * jump], exp2(falloff * float(away * away)));
  }
  target[at] = filtered(range);
}
