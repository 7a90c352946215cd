#pragma once
/// Start states for comparisons of methods: all methods start from one state of finest particles, which is
/// merged as far as each method's target levels allow. This code runs on the host, before a run; during a run
/// the solver's stages merge particles.

#include <cstdint>
#include <span>
#include <vector>

#include "libsim/particles/particle_state.hpp"

namespace sim {

/// Builds a kd-tree over the particles with leaves of exactly eight. A node is divided along the longest axis
/// of its box, ties by id, into two parts as equal as multiples of eight particles allow. Leaves are halved
/// further, down to single particles. Merges a node of 2^l particles, l = 3, 2, 1, if all its targets are >=
/// l. A merged particle has the members' mean position and velocity and the lowest of their ids. The sum of
/// 2^level equals the number of particles given; if all targets are 3, an eighth of the particles remains.
/// Input: a multiple of eight particles, all of level 0, with unique ids, and one target 0 .. 3 for each.
/// std::invalid_argument for another count, level or target, or a position that is not finite. Output:
/// ordered by id. The result does not depend on the order of the input.
std::vector<ParticleState> coarsen(std::span<const ParticleState> finest,
                                   std::span<const std::uint8_t> targets);

}  // namespace sim
