// Depth is splatted in two rounds. The first takes the particles that were in front in the last picture and an
// eighth of the rest; the farthest depth of each block of pixels then tells the second round which particles
// cannot be seen. Only hidden ones are left out, so the picture does not depend on who went first.
const int block_px = 16;
const uint may_be_in_front = 1u;  // bits of touched[]; this one: was in front of a pixel when it was splatted
const uint in_first_round = 2u;
const uint is_hidden = 4u;
const uint was_in_front = 8u;  // of a pixel when all were splatted

bool goes_first(uint i, uint last) { return (last & was_in_front) != 0u || ((i >> 5) & 7u) == 0u; }
