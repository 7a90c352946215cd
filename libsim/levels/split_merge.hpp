#pragma once
/// The parts of the pass that splits and merges.

#include "libsim/levels/split_pattern.hpp"
#include "libsim/neighbors/neighbour_list.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

using LevelView =
    ColumnView<columns(Column::Position, Column::Velocity, Column::Id, Column::Level, Column::Target,
                       Column::History, Column::Age, Column::Waiting, Column::Neighbours),
               columns(Column::Position, Column::Velocity, Column::Id, Column::Level, Column::History,
                       Column::Age, Column::Waiting)>;

/// The fluid as input of splitting and merging.
struct LevelFluid {
  LevelView particles;
  ParticleNeighbours neighbours;
  const std::uint8_t* last_active;  ///< flags of the particles solved in the last frame; nullptr if all were
  Solids solids;                    ///< walls, and obstacles if there are any
  LevelSupports supports;
  float rest_density;  ///< kg/m3
  float wall_gap;      ///< minimum distance to a wall, as a share of d
};

/// True if the particle is surrounded by water, or by water and walls. Counts its neighbours as if all were
/// of its level: a coarser one is listed at a larger distance, and so counts as more than one, but less than
/// its mass ratio.
template <class Boundary, class Team>
SIM_FN bool inside_fluid(const Boundary& walls, const Vec4* position, const ParticleNeighbours& neighbours,
                         int i, float least, Team team) {
  const Vec4 self = position[i];
  const int size = neighbours.size(i);
  const NeighbourRun run = neighbours.run(i);
  float count = 0;
  for (int k = team.rank(); k < size; k += Team::size) {
    const float other = position[run[k]].w;
    const float ratio = quotient(2 * other, self.w + other);
    count += ratio * ratio * ratio;
  }
  Vec3 gradient;
  return team.sum(count) >= least * (1 - walls.missing(xyz(self), self.w, gradient));
}

/// True if this position is outside all obstacles. No wall can be between two particles.
SIM_FN bool free_of_bodies(const Walls&, Vec3) { return true; }
SIM_FN bool free_of_bodies(const Solids& solids, Vec3 x) { return solids.nearest_body(x) > 0; }

/// Fills split_code (0 = no split). Returns false if no particle splits.
bool choose_splits(LevelState& levels, const LevelFluid& fluid);
/// Merges pairs in place: the particle with the lower id becomes the merged one, the other is marked in
/// `gone`.
void merge_pairs(LevelState& levels, const LevelFluid& fluid, const Descents& descents);
/// Merges particles that waited without a partner, through a coarser particle between two of them.
void relay_stranded(LevelState& levels, const LevelFluid& fluid, const Descents& descents);
/// Creates the children and closes the gaps: the number of particles changes. `particles` are the fluid's.
void compact(LevelState& levels, const LevelFluid& fluid, Particles& particles, bool any_split);

/// Updates ages in a frame without splits and merges.
void grow_older(LevelState& levels, const LevelView& particles);
/// All splits and merges of a frame; levels.changed is true if there were any.
void split_and_merge(LevelState& levels, const LevelFluid& fluid, Particles& particles);

}  // namespace sim::SIM_BACKEND
