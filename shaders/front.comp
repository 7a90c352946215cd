// Writes per pixel the lowest index among the particles whose depth equals the pixel's depth; one invocation per
// particle. Handles particles with small footprints; splat_wide.comp handles those with large footprints.
#include "view.glsl"
#include "sphere.glsl"
#include "targets.glsl"
#include "front.glsl"
#include "occlusion.glsl"
layout(local_size_x = 64) in;
uniform int thread_limit;

void main() {
  const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (i >= particle_count || (touched[i] & may_be_in_front) == 0u) return;
  const Sphere s = sphere_of(i);
  const ivec4 box = footprint(s, rays, size.xy);
  const ivec2 extent = box.zw - box.xy;
  if (max(extent.x, extent.y) > thread_limit) return;
  const vec4 grid = rays;
  const int row = size.x;
  const bool subpixel = is_subpixel(s, grid);
  for (int y = box.y; y < box.w; ++y) {
    for (int x = box.x; x < box.z; ++x) {
      const int at = y * row + x;
      splat_front(s, ivec2(x, y), subpixel, grid, at, depth_bits[at], i);
    }
  }
}
