// One work group a listed particle (gl_WorkGroupID.z counts those that share one): 8 x 8 px at a time.
#include "view.glsl"
#include "sphere.glsl"
#include "targets.glsl"
#include "wide_list.glsl"
#include "occlusion.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
uniform int tiles;  // 0: the group items, 1: the tile items

ivec2 block_corner(ivec4 box, int block) {
  const int across = (box.z - box.x + 7) / 8;
  return box.xy + 8 * ivec2(block % across, block / across);
}

int block_count(ivec4 box) {
  const ivec2 blocks = (box.zw - box.xy + 7) / 8;
  return max(blocks.x, 0) * max(blocks.y, 0);
}

bool holds(ivec4 box, ivec2 cell) { return all(lessThan(cell, box.zw)); }

void main() {
  const uint item = (tiles == 0 ? group_start : tile_start) + gl_WorkGroupID.y * group_row + gl_WorkGroupID.x;
  if (item >= (tiles == 0 ? group_items : tile_items)) return;
  const uint i = items[(tiles == 0 ? 0u : particle_count) + item];
  const int step = int(gl_NumWorkGroups.z);
  const ivec2 within = ivec2(gl_LocalInvocationID.xy);
  const Sphere s = sphere_of(particles[i]);
#ifdef FRONT
  if ((touched[i] & was_in_front) == 0u) return;
  const ivec4 box = footprint(s, rays, size.xy);
  for (int block = int(gl_WorkGroupID.z); block < block_count(box); block += step) {
    const ivec2 pixel = block_corner(box, block) + within;
    if (holds(box, pixel)) splat_front(s, pixel, false, rays, size.x, i);
  }
#else
  const ivec4 box = (touched[i] & is_hidden) != 0u ? ivec4(0) : footprint(s, rays, size.xy);
  bool in_front = false;
  for (int block = int(gl_WorkGroupID.z); block < block_count(box); block += step) {
    const ivec2 pixel = block_corner(box, block) + within;
    if (holds(box, pixel) && splat_depth(s, pixel, false, rays, size.x)) in_front = true;
  }
  if (in_front) atomicOr(touched[i], was_in_front);
  const vec4 grid = thickness_rays();
  const ivec4 cells = footprint(s, grid, size.zw);
  const bool subpixel = is_subpixel(s, grid);
  for (int block = int(gl_WorkGroupID.z); block < block_count(cells); block += step) {
    const ivec2 cell = block_corner(cells, block) + within;
    if (holds(cells, cell)) splat_thickness(s, cell, subpixel, grid, size.z, thickness_rule.x);
  }
#endif
}
