// One pass, along x or y, of a Gaussian filter over the thickness grid. Its standard deviation is half the splatted
// radius of the particle in front. FIRST: the input is in fixed point.
#include "view.glsl"
#include "counters.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Depth { float depth[]; };
layout(std430, binding = 2) readonly buffer Radius { float radii[]; };
layout(std430, binding = 3) writeonly buffer Target { float target[]; };
#ifdef FIRST
layout(std430, binding = 5) readonly buffer Source { uint source[]; };
#else
layout(std430, binding = 5) readonly buffer Source { float source[]; };
#endif
uniform ivec2 direction;
const int most_taps = 6;

float sigma_cells(ivec2 cell) {
  const ivec2 pixel = min(cell * int(thickness_rule.z), size.xy - 1);
  const int at = pixel.y * size.x + pixel.x;
  if (radii[at] == 0.0) return 0.0;
  return 0.5 * radii[at] * origin.w / (depth[at] * rays.x * thickness_rule.z);
}

void main() {
  const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(cell, size.zw))) return;
  const int at = cell.y * size.z + cell.x;
#ifdef FIRST
  if (source[at] == 0xffffffffu) atomicAdd(thickness_full, 1u);
#endif
  const float sigma = sigma_cells(cell);
  const float reach = 2.0 * sigma;
  const int taps = min(int(ceil(reach)), most_taps);
  const float stride = max(reach / float(max(taps, 1)), 1.0);
  const float falloff = -0.72134752 / max(sigma * sigma, 1e-6);
  const int room = direction.x == 1 ? min(cell.x, size.z - 1 - cell.x) : min(cell.y, size.w - 1 - cell.y);
  const int jump = direction.x == 1 ? 1 : size.z;
  float sum = float(source[at]), weight = 1.0;
  for (int k = 1; k <= taps; ++k) {
    const int away = int(float(k) * stride + 0.5);
    if (away > room) break;
    const float w = exp2(falloff * float(away * away));
    sum += w * (float(source[at - away * jump]) + float(source[at + away * jump]));
    weight += 2.0 * w;
  }
  target[at] = sum / weight;
}
