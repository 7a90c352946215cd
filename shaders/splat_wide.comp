// Splats the particles with large footprints, which splat.comp listed (wide_list.glsl). A team of 8 x 4 invocations
// splats a group item, a footprint of up to group_limit px per side. A tile item, a larger footprint, is split among 8
// x (gl_NumWorkGroups.z / 8) work groups.
#include "view.glsl"
#include "sphere.glsl"
#include "targets.glsl"
#include "wide_list.glsl"
#include "occlusion.glsl"
layout(local_size_x = 8, local_size_y = 16) in;
uniform int tiles;  // 0: the group items, 1: the tile items
const ivec2 team = ivec2(8, 4);
const int ahead = 4;  // number of depths that an invocation reads before it compares the first one

#ifdef FRONT
#include "front.glsl"
bool takes_part(uint known) { return (known & may_be_in_front) != 0u; }
#else
bool takes_part(uint known) { return (known & is_hidden) == 0u; }
#endif

// True if the particle may be in front at this pixel; always false in the front pass.
bool splat_pixel(Sphere s, ivec2 pixel, int at, uint held, uint i) {
#ifdef FRONT
  splat_front(s, pixel, false, rays, at, held, i);
  return false;
#else
  return splat_depth(s, pixel, false, rays, at, held);
#endif
}

// Splats every step-th pixel along x and y, from `first` on. Columns count from a multiple of 8 px, where a sector of
// memory begins.
void splat_pixels(Sphere s, uint i, ivec2 first, ivec2 step) {
  const ivec4 box = footprint(s, rays, size.xy);
  const int down = step.y * size.x;
  bool in_front = false;
  for (int x = (box.x & ~7) + first.x; x < box.z; x += step.x) {
    if (x < box.x) continue;
    for (int y = box.y + first.y; y < box.w; y += ahead * step.y) {
      const int at = y * size.x + x;
      uint held[ahead];
      for (int k = 0; k < ahead; ++k) held[k] = y + k * step.y < box.w ? depth_bits[at + k * down] : 0u;
      for (int k = 0; k < ahead; ++k) {
        if (splat_pixel(s, ivec2(x, y + k * step.y), at + k * down, held[k], i)) in_front = true;
      }
    }
  }
  if (in_front) touched[i] |= may_be_in_front;  // other invocations write the same value
}

void splat_cells(Sphere s, ivec2 first, ivec2 step) {
  const vec4 grid = thickness_rays();
  const ivec4 box = footprint(s, grid, size.zw);
  const bool subpixel = is_subpixel(s, grid);
  for (int x = (box.x & ~7) + first.x; x < box.z; x += step.x) {
    if (x < box.x) continue;
    for (int y = box.y + first.y; y < box.w; y += step.y)
      splat_thickness(s, ivec2(x, y), subpixel, grid, size.z, thickness_rule.x);
  }
}

void splat(uint i, ivec2 first, ivec2 step) {
  const bool in_depth = takes_part(touched[i]);
#ifdef FRONT
  if (!in_depth) return;
#endif
  const Sphere s = sphere_of(i);
  if (in_depth) splat_pixels(s, i, first, step);
#ifndef FRONT
  splat_cells(s, first, step);
#endif
}

void main() {
  const ivec2 within = ivec2(gl_LocalInvocationID.xy), whole = ivec2(gl_WorkGroupSize.xy);
  const uint group = gl_WorkGroupID.y * group_row + gl_WorkGroupID.x;
  if (tiles == 1) {
    if (tile_start + group >= tile_items) return;
    const int share = int(gl_WorkGroupID.z), rows = int(gl_NumWorkGroups.z) / 8;
    splat(items[particle_count + tile_start + group], within + whole * ivec2(share % 8, share / 8),
          whole * ivec2(8, rows));
    return;
  }
  const uint own = group_start + group_teams * group + uint(within.y / team.y);
  if (own < group_items) splat(items[own], ivec2(within.x, within.y % team.y), team);
}
