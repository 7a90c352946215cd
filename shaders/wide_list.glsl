// List of the particles whose footprints are too large for one invocation, and the numbers of work groups that splat
// them. One team of invocations splats a group item (a footprint of up to group_limit px per side, splat.comp), many
// work groups a tile item (a larger footprint). The list grows in two rounds; the items of the current round begin at
// group_start and tile_start.
const uint group_row = 32768u;  // most work groups along x; further ones lie along y
const uint group_teams = 4u;    // group items per work group
layout(std430, binding = 5) buffer WideList {
  uint group_items;
  uint tile_items;
  uint group_dispatch[3];
  uint tile_dispatch[3];
  uint group_start;
  uint tile_start;
  uint group_next;
  uint tile_next;
  uint items[];  // group items from 0, tile items from particle_count
};
