// Particles whose footprints are too large for one invocation, and the work groups that take them.
const uint group_row = 32768u;  // work groups in x; the rest goes into y
layout(std430, binding = 5) buffer WideList {
  uint group_items;
  uint tile_items;
  uint group_dispatch[3];
  uint tile_dispatch[3];
  uint items[];  // group items from 0, tile items from particle_count
};
