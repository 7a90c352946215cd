#pragma once
/// The parts of the pass that splits and merges. The 2^k children of a split (ViP-Fluid, Algorithm 1) lie on
/// 2^(k-1) diagonals of a randomly rotated cube.

#include "libsim/levels/level_state.hpp"
#include "libsim/neighbors/neighbour_list.hpp"
#include "libsim/particles/kernels.hpp"
#include "libsim/particles/random.hpp"
#include "libsim/particles/solids.hpp"

namespace sim::SIM_BACKEND {

/// Describes a split: into 2^k children, rotated by the `attempt`-th random rotation.
struct SplitCode {
  int k, attempt;
  static constexpr int attempts = 4;

  SIM_FN std::uint8_t packed() const { return static_cast<std::uint8_t>(k | attempt << 2); }
  SIM_FN static SplitCode unpacked(std::uint8_t code) { return {code & 3, code >> 2}; }
};

/// A rotation, as three rows.
struct Turn {
  Vec3 x, y, z;
  SIM_FN Vec3 operator()(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

/// A random rotation, uniform over all rotations (K. Shoemake 1992), computed from id, frame and attempt
/// alone.
SIM_FN Turn random_turn(int id, std::uint32_t frame, int attempt) {
  const auto uniform = [&](std::uint32_t which) {
    const std::uint32_t salt = 3 * static_cast<std::uint32_t>(attempt) + which;
    return uniform_of(random_bits(static_cast<std::uint32_t>(id), frame, salt));
  };
  const float u = uniform(0);
  const float a = 2 * pi * uniform(1);
  const float b = 2 * pi * uniform(2);
  const float qx = sqrtf(1 - u) * sinf(a);
  const float qy = sqrtf(1 - u) * cosf(a);
  const float qz = sqrtf(u) * sinf(b);
  const float qw = sqrtf(u) * cosf(b);
  return {{1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qz * qw), 2 * (qx * qz + qy * qw)},
          {2 * (qx * qy + qz * qw), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qx * qw)},
          {2 * (qx * qz - qy * qw), 2 * (qy * qz + qx * qw), 1 - 2 * (qx * qx + qy * qy)}};
}

/// Offset of child c, 0 <= c < 2^k, from a parent of radius r. Children 2 n and 2 n + 1 are opposite each
/// other, so that the centre of mass and, with equal velocities, the angular momentum are conserved.
SIM_FN Vec3 child_offset(const Turn& turn, const LevelRules& rules, SplitCode code, float radius, int c) {
  const int diagonal = c / 2;
  const float sign = c % 2 ? -1.0f : 1.0f;
  const Vec3 corner{diagonal == 3 ? -1.0f : 1.0f, diagonal == 2 ? -1.0f : 1.0f, diagonal == 1 ? -1.0f : 1.0f};
  const float length = rules.split_offset[code.k - 1] * radius * 0.577350269f;
  return (sign * length) * turn(corner);
}

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
  bool merges_pause = true;         ///< particles that rested in the last frame do not merge
  Solids solids;                    ///< walls, and obstacles if there are any
  LevelSupports supports;
  float rest_density;  ///< kg/m3
  float wall_gap;      ///< minimum distance to a wall, as a share of the particle diameter d
};

/// True if particle i is surrounded by water, or by water and walls: it has at least `least` neighbours, or
/// fewer beside a wall. Neighbour j of support h_j has the weight (h_j / h)^3, with the mean support h of
/// the pair: fewer coarse than fine particles fit within the distance h, so coarse neighbours weigh more.
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

/// True if position x, between two particles, is outside all obstacles. In a scene without obstacles always
/// true: walls need no test, because no wall lies between two particles.
SIM_FN bool free_of_bodies(const Walls&, Vec3) { return true; }
SIM_FN bool free_of_bodies(const Solids& solids, Vec3 x) { return solids.nearest_body(x) > 0; }

/// Fills split_code (0 = no split). Returns false if no particle can split; true even if the capacity then
/// refuses every split.
bool choose_splits(LevelState& levels, const LevelFluid& fluid);
/// Updates ages, histories and waiting times, then merges pairs in place: the particle with the lower id
/// becomes the merged one, the other is marked in `gone`.
void merge_pairs(LevelState& levels, const LevelFluid& fluid, const Descents& descents);
/// Merges particles that waited without a partner, through a coarser particle between two of them.
void relay_stranded(LevelState& levels, const LevelFluid& fluid, const Descents& descents);
/// Creates the children of splits and removes merged particles from the arrays. The number of particles may
/// change. `particles`: the particles of `fluid`.
void compact(LevelState& levels, const LevelFluid& fluid, Particles& particles, bool any_split);

/// Increases the age of all particles, in a frame that does not update the levels.
void grow_older(LevelState& levels, const LevelView& particles);
/// All splits and merges of a frame; sets levels.changed.
void split_and_merge(LevelState& levels, const LevelFluid& fluid, Particles& particles);

}  // namespace sim::SIM_BACKEND
