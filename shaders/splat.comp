// One invocation a particle: counts it, splats it when it is small, lists it when it is not.
#include "view.glsl"
#include "sphere.glsl"
#include "targets.glsl"
#include "counters.glsl"
#include "wide_list.glsl"
layout(local_size_x = 64) in;
uniform int thread_limit;  // px a side that one invocation splats
uniform int group_limit;   // px a side that one work group splats

bool splat_small(Sphere s, ivec4 box) {
  const bool subpixel = is_subpixel(s, rays);
  bool in_front = false;
  for (int y = box.y; y < box.w; ++y) {
    for (int x = box.x; x < box.z; ++x) {
      if (splat_depth(s, ivec2(x, y), subpixel)) in_front = true;
    }
  }
  return in_front;
}

void splat_small_thickness(Sphere s) {
  const vec4 grid = thickness_rays();
  const ivec4 box = footprint(s, grid, size.zw);
  const bool subpixel = is_subpixel(s, grid);
  for (int y = box.y; y < box.w; ++y) {
    for (int x = box.x; x < box.z; ++x) splat_thickness(s, ivec2(x, y), subpixel, grid);
  }
}

void main() {
  const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (i >= particle_count) return;
  touched[i] = 0u;
  const vec4 particle = particles[i];
  if (!is_usable(particle)) {
    atomicAdd(not_finite, 1u);
    return;
  }
  const Sphere s = sphere_of(particle);
  const ivec4 box = footprint(s, rays, size.xy);
  const ivec2 extent = box.zw - box.xy;
  if (extent.x <= 0 || extent.y <= 0) {
    atomicAdd(outside, 1u);
    return;
  }
  if (crosses_near(s)) atomicAdd(near_crossing, 1u);
  if (is_subpixel(s, rays)) atomicAdd(subpixel_count, 1u);
  const int longest = max(extent.x, extent.y);
  if (longest > group_limit) {
    items[particle_count + atomicAdd(tile_items, 1u)] = i;
  } else if (longest > thread_limit) {
    items[atomicAdd(group_items, 1u)] = i;
  } else {
    if (splat_small(s, box)) touched[i] = 1u;
    splat_small_thickness(s);
  }
}
