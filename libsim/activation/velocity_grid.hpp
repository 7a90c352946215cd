#pragma once
/// Grids of cells with the mean velocity V of each level and the kinetic energy E of all levels. They last
/// from frame to frame. The cells of ViP-Fluid section 4.3 have an edge of 10 d_*, with d_* the spacing of
/// the finest particles: 1000 of these particles fill a cell.

#include <cstdint>

#include "libsim/exec/passes.hpp"
#include "libsim/particles/cells.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

constexpr int grid_levels = 4;

/// Mass (in m_*, the mass of a particle of level 0) and momentum (in m_* m/s times 2^20) of the particles of
/// one cell and level, in fixed point, so that the order of addition does not matter.
struct MomentumSum {
  std::uint64_t mass, x, y, z;
};

/// momentum / mass, m/s; the sum must not be empty.
SIM_FN Vec3 mean_velocity(const MomentumSum& sum) {
  const auto part = [&](std::uint64_t momentum) {
    return static_cast<float>(static_cast<double>(static_cast<std::int64_t>(momentum)) /
                              (static_cast<double>(sum.mass) * 1048576.0));
  };
  return {part(sum.x), part(sum.y), part(sum.z)};
}

/// Values of w in the Vec4 of a cell and level, which say where its velocity comes from. value_unknown: there
/// is no velocity.
constexpr float value_unknown = 0;
constexpr float value_borrowed = 1;  ///< from the previous frame, or from other levels
constexpr float value_measured = 2;  ///< from particles of this level

/// The eight cell centres around a position, clamped at the grid's borders, and their weights for
/// interpolation.
struct CellCorners {
  int cell[8];
  float weight[8];
};

/// The grid's cells in the form that kernels use. The value of (level, cell) has the index level x cells() +
/// cell.
struct GridFrame {
  CellFrame frame;
  CellBlock block;

  SIM_FN int cells() const { return block.size(); }
  SIM_FN int clamped(float at, int n) const {
    return static_cast<int>(at_most(at_least(floorf(at), 0.0f), static_cast<float>(n - 1)));
  }
  /// The cell that contains x, or the nearest one.
  SIM_FN int cell_of(Vec3 x) const {
    const Vec3 at = (1 / frame.edge) * (x - frame.low);
    return block.index(clamped(at.x, block.nx), clamped(at.y, block.ny), clamped(at.z, block.nz));
  }
  SIM_FN CellCorners corners(Vec3 x) const {
    const Vec3 at = (1 / frame.edge) * (x - frame.low);
    const float place[3] = {at.x - 0.5f, at.y - 0.5f, at.z - 0.5f};
    const int size[3] = {block.nx, block.ny, block.nz};
    int first[3];
    int second[3];
    float part[3];
    for (int k = 0; k < 3; ++k) {
      const float inside = at_most(at_least(place[k], 0.0f), static_cast<float>(size[k] - 1));
      first[k] = static_cast<int>(inside);
      second[k] = first[k] + 1 < size[k] ? first[k] + 1 : first[k];
      part[k] = inside - static_cast<float>(first[k]);
    }
    CellCorners out;
    for (int c = 0; c < 8; ++c) {
      out.cell[c] = block.index(c & 1 ? second[0] : first[0], c & 2 ? second[1] : first[1],
                                c & 4 ? second[2] : first[2]);
      out.weight[c] =
          (c & 1 ? part[0] : 1 - part[0]) * (c & 2 ? part[1] : 1 - part[1]) * (c & 4 ? part[2] : 1 - part[2]);
    }
    return out;
  }
};

/// Weighted mean over the corners that have a value; if none has one, w of the result is value_unknown.
SIM_FN Vec4 sample(const Vec4* values, int offset, const CellCorners& corners) {
  Vec3 sum{0, 0, 0};
  float weights = 0;
  for (int c = 0; c < 8; ++c) {
    const Vec4 value = values[offset + corners.cell[c]];
    if (value.w == value_unknown) continue;
    sum += corners.weight[c] * xyz(value);
    weights += corners.weight[c];
  }
  if (weights <= 0) return {0, 0, 0, value_unknown};
  return with_w((1 / weights) * sum, value_measured);
}

/// Columns of the particles that the grids sum over.
using MovingView = Reads<Column::Position, Column::Velocity, Column::Level>;

/// The particles in a sum. Resting and Solved are values of Active; All does not read Active.
enum class Whose : std::uint8_t { Resting = 0, Solved = 1, All = 254, Unused = 255 };

/// Selects the particles and the cells of one sum.
struct MomentumOf {
  Whose whose = Whose::Unused;
  GridFrame grid{};
  const int* cell_of = nullptr;  ///< cell of each particle; nullptr: from its position
};

/// Sums of mass and momentum by cell and level; several sums are computed in one launch.
class CellMomentum {
 public:
  static constexpr int most = 3;

  /// Computes these sums in one launch, replacing earlier ones. active: the column Active; may be nullptr if
  /// every sum is Whose::All or Unused.
  template <int n>
  void measure(MovingView particles, const std::uint8_t* active, const MomentumOf (&sums)[n]) {
    static_assert(n <= most);
    measure(particles, active, sums, n);
  }
  /// The k-th sum: [level x cells + cell]; nullptr if it is Whose::Unused. Valid until the next measure() or
  /// reserve().
  const MomentumSum* of(int k) const { return of_[k]; }
  /// Allocates memory for sums with a total of `cells` cells; discards earlier sums.
  void reserve(int cells) {
    for (auto& sum : of_) sum = nullptr;
    sums_.reserve(grid_levels * static_cast<std::size_t>(cells));
  }
  std::size_t bytes() const { return sums_.bytes(); }

 private:
  void measure(MovingView particles, const std::uint8_t* active, const MomentumOf* sums, int n);

  Array<MomentumSum> sums_;
  MomentumSum* of_[most] = {};
};

/// Converts momentum sums to mean velocities. Entries without particles keep the last frame's measured
/// velocity, else the mean over the levels of the cell (VelocityGrid::finish_velocity).
struct FinishVelocity {
  const MomentumSum* sums;
  Vec4* velocity;
  int cells;

  SIM_FN void operator()(int i) const {
    if (sums[i].mass > 0) {
      velocity[i] = with_w(mean_velocity(sums[i]), value_measured);
      return;
    }
    if (velocity[i].w == value_measured) {
      velocity[i].w = value_borrowed;
      return;
    }
    MomentumSum all{};
    for (int level = 0; level < grid_levels; ++level) {
      const MomentumSum& other = sums[level * cells + i % cells];
      all = {all.mass + other.mass, all.x + other.x, all.y + other.y, all.z + other.z};
    }
    velocity[i] = all.mass > 0 ? with_w(mean_velocity(all), value_borrowed) : Vec4{0, 0, 0, value_unknown};
  }
};

/// Cells of `edge` that cover the domain: ceil(extent / edge), at least one per axis. Edges are longer if
/// there would be more than 2^22 cells.
GridFrame cells_over(const Domain& domain, float edge);

class VelocityGrid {
 public:
  /// Covers the domain with cells_over(domain, edge). Discards all values if the cells change.
  void fit(const Domain& domain, float edge);
  /// Discards all values.
  void forget();
  GridFrame frame() const { return {frame_, block_}; }
  int cells() const { return block_.size(); }

  /// The pass that computes V from a sum over frame(): mass-weighted mean velocity per cell and level, m/s.
  /// An entry without particles keeps the previous frame's measured value for one frame. After that it takes
  /// the mean over all levels of the cell, or becomes value_unknown in a cell without particles. Without a
  /// sum (nullptr) V does not change.
  Pass<FinishVelocity> finish_velocity(const MomentumSum* sums) {
    return {sums ? grid_levels * cells() : 0, {sums, velocity_.data(), cells()}};
  }
  /// Updates E, the kinetic energy of all particles of each cell, in m_* m2/s2, with m_* the mass of the
  /// finest particles.
  void update_energy(MovingView particles);

  const Array<Vec4>& velocity() const { return velocity_; }
  const Array<float>& energy() const { return energy_; }
  std::size_t bytes() const;
  /// Saves or restores the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(frame_, block_, velocity_, energy_);
    if constexpr (Archive::reads) make_energy_sums();
  }

 private:
  void make_energy_sums();

  CellFrame frame_;
  CellBlock block_;
  Array<std::uint64_t> energy_sums_;  ///< zero except during update_energy()
  Array<Vec4> velocity_;
  Array<float> energy_;
};

}  // namespace sim::SIM_BACKEND
