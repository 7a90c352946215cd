// Particles whose footprints are too large for one invocation, and the work groups that take them. The list grows
// in two rounds; a round's own part begins at *_start.
const uint group_row = 32768u;  // work groups in x; the rest goes into y
const uint group_teams = 4u;    // group items that a work group takes
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
