#pragma once
/// Code shared by merging a pair and merging through a relay.

#include "libsim/levels/split_merge.hpp"

namespace sim::SIM_BACKEND {

/// True if a particle at `other` and a particle of support h at `centre` are at least `share` of the sum of
/// their radii apart.
SIM_FN bool clear_of(Vec4 other, Vec3 centre, float h, float share) {
  const Vec3 offset = xyz(other) - centre;
  const float least = share * (other.w + h) / 4;
  return dot(offset, offset) >= least * least;
}

/// True if a merged particle of support h at `centre` would overlap a neighbour of particle i that is coarser
/// than `level` (ViP-Fluid, Fig. 5 d2). `level`: level of the two particles that merge. `share`: as in
/// clear_of.
template <class Team>
SIM_FN bool overlaps_coarser(const Vec4* position, const std::uint8_t* levels,
                             const ParticleNeighbours& neighbours, int i, int level, Vec3 centre, float h,
                             float share, Team team) {
  const int size = neighbours.size(i);
  const NeighbourRun run = neighbours.run(i);
  bool overlaps = false;
  for (int k = team.rank(); k < size && !overlaps; k += Team::size) {
    const int other = run[k];
    overlaps = levels[other] > level && !clear_of(position[other], centre, h, share);
  }
  return team.any(overlaps);
}

/// Merges two particles: mass, momentum and centre of mass are conserved, kinetic energy can only decrease.
struct Joining {
  Vec4* position;
  Vec4* velocity;
  std::uint8_t* level;
  std::uint8_t* history;
  Descents descents;
  std::uint8_t* gone;
  LevelCounts* counts;
  LevelSupports supports;
  float rest_density;

  SIM_FN Vec3 mean(const Vec4* values, int a, int b) const {
    return 0.5f * (xyz(values[a]) + xyz(values[b]));
  }
  /// Kinetic energy, J, that is lost when particle i merges with an equal mass taken from particle j.
  SIM_FN float loss(int j, int i) const {
    const Vec3 difference = xyz(velocity[j]) - xyz(velocity[i]);
    return 0.25f * mass_of(position[i].w, rest_density) * dot(difference, difference);
  }
  SIM_FN void become(int i, Vec3 x, Vec3 v, float h, int now) const {
    position[i] = with_w(x, h);
    velocity[i] = with_w(v, 0);
    level[i] = static_cast<std::uint8_t>(now);
    history[i] = steady_history(now);
  }
  /// Marks particle i as removed, and counts the merge and the kinetic energy lost in it, J.
  SIM_FN void leave(int i, float lost) const {
    gone[i] = 1;
    atomic_add(&counts->merges, std::uint64_t{1});
    atomic_add(&counts->energy_lost_uj, static_cast<std::uint64_t>(1e6f * fminf(lost, 1e9f)));
  }
  /// Merges two particles of one level at their midpoint.
  SIM_FN void join(int kept, int left) const {
    const float lost = loss(left, kept);
    const int coarser = level[kept] + 1;
    become(kept, mean(position, kept, left), mean(velocity, kept, left), supports.h[coarser], coarser);
    descents.join(kept, left);
    leave(left, lost);
  }
};

inline Joining joining(LevelState& levels, const LevelFluid& fluid, const Descents& descents) {
  const LevelView& p = fluid.particles;
  return {.position = p.position(),
          .velocity = p.velocity(),
          .level = p.level(),
          .history = p.history(),
          .descents = descents,
          .gone = levels.gone.data(),
          .counts = levels.counts.data(),
          .supports = fluid.supports,
          .rest_density = fluid.rest_density};
}

}  // namespace sim::SIM_BACKEND
