// Depth is splatted in two rounds. The first round takes the particles that lie in front of the surface of the last
// picture or close behind it. The second round skips the depth of each particle that lies behind the farthest depth of
// every block of pixels under its footprint, unless the particle is smaller than a pixel. Only hidden particles are
// skipped, so that the picture does not depend on the choice for the first round.
const int block_px = 16;
const uint may_be_in_front = 1u;  // bit of touched[]: the particle was in front of a pixel when it was splatted
const uint in_first_round = 2u;   // bit of touched[]: the first round takes the particle
const uint is_hidden = 4u;        // bit of touched[]: splat_wide.comp skips the particle's depth
