// Turns the two list lengths into work groups.
#include "counters.glsl"
#include "wide_list.glsl"
layout(local_size_x = 1) in;
uniform uint tile_groups;  // work groups that share one very large footprint

void main() {
  by_group += group_items;
  by_tiles += tile_items;
  group_dispatch[0] = min(group_items, group_row);
  group_dispatch[1] = (group_items + group_row - 1u) / group_row;
  group_dispatch[2] = 1u;
  tile_dispatch[0] = min(tile_items, group_row);
  tile_dispatch[1] = (tile_items + group_row - 1u) / group_row;
  tile_dispatch[2] = tile_groups;
}
