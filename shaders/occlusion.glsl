// Depth is splatted in two rounds. The first takes the particles that lie about as near as the water of the last
// picture did there; the farthest depth of each block of pixels then tells the second round which particles
// cannot be seen. Only hidden ones are left out, so the picture does not depend on who went first.
const int block_px = 16;
const uint may_be_in_front = 1u;  // bits of touched[]; this one: was in front of a pixel when it was splatted
const uint in_first_round = 2u;
const uint is_hidden = 4u;
