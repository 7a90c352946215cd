#pragma once
/// Starts for comparisons: every method starts from one state of the finest particles, merged as far as its
/// target levels allow. A pure function on the host; the solver's stages merge during a run.

#include <cstdint>
#include <span>
#include <vector>

#include "libsim/particles/particle_state.hpp"

namespace sim {

/// Builds a median-split kd-tree over the particles (longest axis of the node's box, ties by id) with leaves
/// of exactly eight, continues splitting within the leaves, and merges a node of 2^l particles, l = 3, 2, 1,
/// if all its targets are >= l. A merged particle has the members' mean position and velocity and the lowest
/// of their ids. The sum of 2^level equals the number of particles given; if all targets are 3, exactly an
/// eighth remains. In: particles of level 0 with unique ids, a multiple of eight; one target 0 .. 3 for each
/// (std::invalid_argument). Out: ordered by id. The result does not depend on the order of the input.
std::vector<ParticleState> coarsen(std::span<const ParticleState> finest,
                                   std::span<const std::uint8_t> targets);

}  // namespace sim
