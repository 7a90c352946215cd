// The tiles of 16 x 8 px that outlines touch, and the number of work groups that smooth them.
layout(std430, binding = 3) buffer OutlineTiles {
  uvec4 tile_groups;  // xyz: for an indirect dispatch, one group per entry of the list
  uint tiles[];
};
