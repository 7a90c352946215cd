// Finds outlines: pixels whose right or upper neighbour shows another layer. Depth jumps there, and does not follow
// the slope on either side.
#include "view.glsl"
layout(local_size_x = 16, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Shown { float shown[]; };
layout(std430, binding = 1) readonly buffer Normals { vec4 normals[]; };
layout(std430, binding = 2) writeonly buffer Outlines { uint outlines[]; };  // bit 0: to the right; bit 1: above

const float least_jump_r = 1.2;  // smallest jump of depth between layers of water, splatted radii
const float least_jump = 0.03;   // the same between obstacles, share of the depth

int index_of(ivec2 pixel) {
  const ivec2 inside = clamp(pixel, ivec2(0), size.xy - 1);
  return inside.y * size.x + inside.x;
}

bool is_outline(ivec2 pixel, ivec2 step, float here, float radius) {
  if (any(greaterThanEqual(pixel + step, size.xy))) return false;
  const float there = shown[index_of(pixel + step)];
  if (here == there) return false;
  if (here == 0.0 || there == 0.0) return true;
  const float nearer = max(here, there);
  const float least = nearer * (radius > 0.0 ? least_jump_r * radius * nearer : least_jump);
  const float jump = there - here;
  if (abs(jump) <= least) return false;
  const float before = shown[index_of(pixel - step)], after = shown[index_of(pixel + 2 * step)];
  const float on_this_side = before > 0.0 ? here - before : 0.0, on_that_side = after > 0.0 ? after - there : 0.0;
  return min(abs(jump - on_this_side), abs(jump - on_that_side)) > least;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size.xy))) return;
  const int at = pixel.y * size.x + pixel.x;
  const float here = shown[at], radius = normals[at].w * origin.w;
  outlines[at] = uint(is_outline(pixel, ivec2(1, 0), here, radius)) |
                 uint(is_outline(pixel, ivec2(0, 1), here, radius)) << 1;
}
