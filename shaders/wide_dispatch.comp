// Sets the numbers of work groups for the particles listed in wide_list.glsl: those listed in this round of splatting,
// or (all_items = 1) in both rounds.
#include "counters.glsl"
#include "wide_list.glsl"
layout(local_size_x = 1) in;
uniform uint tile_groups;  // work groups that share one very large footprint
uniform int all_items;

void main() {
  group_start = all_items == 1 ? 0u : group_next;
  tile_start = all_items == 1 ? 0u : tile_next;
  group_next = group_items;
  tile_next = tile_items;
  const uint groups = group_items - group_start, tiles = tile_items - tile_start;
  if (all_items == 0) {
    by_group += groups;
    by_tiles += tiles;
  }
  const uint work_groups = (groups + group_teams - 1u) / group_teams;
  group_dispatch[0] = min(work_groups, group_row);
  group_dispatch[1] = (work_groups + group_row - 1u) / group_row;
  group_dispatch[2] = 1u;
  tile_dispatch[0] = min(tiles, group_row);
  tile_dispatch[1] = (tiles + group_row - 1u) / group_row;
  tile_dispatch[2] = tile_groups;
}
