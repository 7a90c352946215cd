#pragma once
/// The parts of the pass that splits and merges.

#include "libsim/levels/split_pattern.hpp"
#include "libsim/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// Is the particle surrounded by water, or by water and walls? Counts its neighbours as if all were of its
/// level: one that is seen from farther away because it is coarser fills more room and counts for less mass.
SIM_FN bool inside_fluid(const Walls& walls, const Vec4* position, const ParticleNeighbours& neighbours,
                         int i, float least) {
  const Vec4 self = position[i];
  float count = 0;
  for (int k = 0; k < neighbours.size(i); ++k) {
    const float other = position[neighbours(i, k)].w;
    const float ratio = 2 * other / (self.w + other);
    count += ratio * ratio * ratio;
  }
  Vec3 gradient;
  return count >= least * (1 - walls.missing(xyz(self), self.w, gradient));
}

/// Fills split_code (0 = stays). False when nobody splits.
bool choose_splits(FluidState& state);
/// Merges pairs in place: the particle with the lower id becomes the pair, the other is marked in `gone`.
void merge_pairs(FluidState& state);
/// Merges what has waited without a partner through a coarser particle between two such.
void relay_stranded(FluidState& state);
/// Makes the children and closes the gaps: the number of particles changes.
void compact(FluidState& state, bool any_split);

/// The last value, read back from the device; 0 when there is none.
inline int last_of(const Array<int>& values) {
  int out = 0;
  if (values.size()) copy_to_host(&out, values.data() + values.size() - 1, sizeof out);
  return out;
}

}  // namespace sim::SIM_BACKEND
