// Splats the particles in two rounds (occlusion.glsl), one invocation per particle. Small footprints are splatted
// here, larger ones are listed for splat_wide.comp.
#include "view.glsl"
#include "sphere.glsl"
#include "targets.glsl"
#include "counters.glsl"
#include "wide_list.glsl"
#include "occlusion.glsl"
layout(std430, binding = 2) readonly buffer Last { float last_nearness[]; };  // filtered nearness of the last picture
layout(std430, binding = 7) readonly buffer Blocks { uint farthest[]; };
layout(local_size_x = 64) in;
uniform int thread_limit;  // largest footprint that one invocation splats, px per side
uniform int group_limit;   // largest footprint that one team of invocations splats, px per side
uniform int second_round;

// True if the sphere lies behind the splatted depth of every pixel in the blocks under its footprint.
bool hidden(Sphere s, ivec4 box) {
  const int blocks_x = (size.x + block_px - 1) / block_px;
  const ivec2 low = box.xy / block_px, high = (box.zw - 1) / block_px;
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      if (farthest[y * blocks_x + x] >= s.nearest) return false;
    }
  }
  return true;
}

bool splat_small(Sphere s, ivec4 box) {
  const vec4 grid = rays;
  const int row = size.x;
  const bool subpixel = is_subpixel(s, grid);
  bool in_front = false;
  for (int y = box.y; y < box.w; ++y) {
    for (int x = box.x; x < box.z; ++x) {
      const int at = y * row + x;
      if (splat_depth(s, ivec2(x, y), subpixel, grid, at, depth_bits[at])) in_front = true;
    }
  }
  return in_front;
}

void splat_small_thickness(Sphere s) {
  const vec4 grid = thickness_rays();
  const ivec4 box = footprint(s, grid, size.zw);
  const int row = size.z;
  const float units_per_m = thickness_rule.x;
  const bool subpixel = is_subpixel(s, grid);
  for (int y = box.y; y < box.w; ++y) {
    for (int x = box.x; x < box.z; ++x) splat_thickness(s, ivec2(x, y), subpixel, grid, row, units_per_m);
  }
}

// True if the first round takes the sphere: its centre lies at most 3 splatted radii behind the surface of the last
// picture, or it crosses the near plane. With fewer radii, pixels without a splat remain in many blocks, so that the
// second round cannot skip the particles behind them.
bool goes_first(Sphere s) {
  if (crosses_near(s)) return true;
  const vec2 xy = (s.centre.xy / s.centre.z - rays.yw) / rays.xz;
  const ivec2 pixel = ivec2(clamp(xy, vec2(0), vec2(size.xy - 1)));
  return (s.centre.z - 3.0 * s.radius) * last_nearness[pixel.y * size.x + pixel.x] <= 1.0;
}

void main() {
  const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 64u) + gl_GlobalInvocationID.x;
  if (i >= particle_count || (second_round == 1 && (touched[i] & in_first_round) != 0u)) return;
  const vec4 particle = particles[i];
  const bool usable = is_usable(particle);
  const Sphere s = sphere_of(i);
  if (second_round == 0) {
    const bool first = !usable || goes_first(s);
    touched[i] = first ? in_first_round : 0u;
    if (!first) return;
  }
  if (!usable) {
    atomicAdd(not_finite, 1u);
    return;
  }
  if (beyond_walls(particle)) {
    atomicAdd(beyond, 1u);
    return;
  }
  const ivec4 box = footprint(s, rays, size.xy);
  const ivec2 extent = box.zw - box.xy;
  if (extent.x <= 0 || extent.y <= 0) {
    atomicAdd(outside, 1u);
    return;
  }
  if (crosses_near(s)) atomicAdd(near_crossing, 1u);
  if (is_subpixel(s, rays)) atomicAdd(subpixel_count, 1u);
  const bool unseen = second_round == 1 && !is_subpixel(s, rays) && hidden(s, box);
  const int longest = max(extent.x, extent.y);
  if (longest > thread_limit) {
    if (unseen) touched[i] = is_hidden;
    if (longest > group_limit) {
      items[particle_count + atomicAdd(tile_items, 1u)] = i;
    } else {
      items[atomicAdd(group_items, 1u)] = i;
    }
    return;
  }
  if (!unseen && splat_small(s, box)) touched[i] |= may_be_in_front;
  splat_small_thickness(s);
}
