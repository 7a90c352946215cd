// Listed particles. A row of eight invocations takes one with a footprint of up to team_px a side, a whole work group
// takes a larger one, and those of the tile items are split among 8 by gl_NumWorkGroups.z / 8 work groups.
#include "view.glsl"
#include "sphere.glsl"
#include "targets.glsl"
#include "wide_list.glsl"
#include "occlusion.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
uniform int tiles;  // 0: the group items, 1: the tile items
const int team_px = 48;
shared uint too_large;  // a bit for each of the work group's items

struct Job {
  Sphere s;
  ivec4 pixels, cells;  // empty: nothing to do there
};

Job job_of(uint i) {
  Job job;
  job.s = sphere_of(particles[i]);
  job.pixels = job.cells = ivec4(0);
#ifdef FRONT
  if ((touched[i] & was_in_front) != 0u) job.pixels = footprint(job.s, rays, size.xy);
#else
  if ((touched[i] & is_hidden) == 0u) job.pixels = footprint(job.s, rays, size.xy);
  job.cells = footprint(job.s, thickness_rays(), size.zw);
#endif
  return job;
}

bool fits_team(Job job) {
  const ivec2 pixels = job.pixels.zw - job.pixels.xy, cells = job.cells.zw - job.cells.xy;
  return max(max(pixels.x, pixels.y), max(cells.x, cells.y)) <= team_px;
}

// Every step-th cell each way, from `first` on.
void splat(Job job, uint i, ivec2 first, ivec2 step) {
  bool in_front = false;
  for (int y = job.pixels.y + first.y; y < job.pixels.w; y += step.y) {
    for (int x = job.pixels.x + first.x; x < job.pixels.z; x += step.x) {
#ifdef FRONT
      splat_front(job.s, ivec2(x, y), false, rays, size.x, i);
#else
      if (splat_depth(job.s, ivec2(x, y), false, rays, size.x)) in_front = true;
#endif
    }
  }
#ifndef FRONT
  if (in_front) atomicOr(touched[i], was_in_front);
  const vec4 grid = thickness_rays();
  const bool subpixel = is_subpixel(job.s, grid);
  for (int y = job.cells.y + first.y; y < job.cells.w; y += step.y) {
    for (int x = job.cells.x + first.x; x < job.cells.z; x += step.x)
      splat_thickness(job.s, ivec2(x, y), subpixel, grid, size.z, thickness_rule.x);
  }
#endif
}

void main() {
  const ivec2 within = ivec2(gl_LocalInvocationID.xy);
  const uint group = gl_WorkGroupID.y * group_row + gl_WorkGroupID.x;
  if (tiles == 1) {
    if (tile_start + group >= tile_items) return;
    const uint i = items[particle_count + tile_start + group];
    const int share = int(gl_WorkGroupID.z), rows = int(gl_NumWorkGroups.z) / 8;
    splat(job_of(i), i, within + 8 * ivec2(share % 8, share / 8), 8 * ivec2(8, rows));
    return;
  }
  const uint first = group_start + group_teams * group;
  if (gl_LocalInvocationIndex == 0u) too_large = 0u;
  barrier();
  const uint own = first + gl_LocalInvocationID.y;
  if (own < group_items) {
    const uint i = items[own];
    const Job job = job_of(i);
    if (fits_team(job)) {
      splat(job, i, ivec2(within.x, 0), ivec2(8, 1));
    } else if (within.x == 0) {
      atomicOr(too_large, 1u << within.y);
    }
  }
  barrier();
  for (uint k = 0u; k < group_teams; ++k) {
    if ((too_large & 1u << k) == 0u) continue;
    const uint i = items[first + k];
    splat(job_of(i), i, within, ivec2(8));
  }
}
