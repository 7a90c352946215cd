#pragma once
/// Mean velocity of each level and kinetic energy of all, on cells of edge 10 d_* (ViP-Fluid section 4.3:
/// 1000 finest particles a cell). V and E are state: they last from frame to frame.

#include <cstdint>

#include "libsim/exec/passes.hpp"
#include "libsim/particles/cells.hpp"
#include "libsim/particles/particles.hpp"

namespace sim::SIM_BACKEND {

constexpr int grid_levels = 4;

/// Sums over the particles of one cell and level in fixed point, so that the order of adding does not matter:
/// mass in m_*, momentum in m_* m/s times 2^20.
struct MomentumSum {
  std::uint64_t mass, x, y, z;
};

/// momentum / mass of a sum that is not empty.
SIM_FN Vec3 mean_velocity(const MomentumSum& sum) {
  const auto part = [&](std::uint64_t momentum) {
    return static_cast<float>(static_cast<double>(static_cast<std::int64_t>(momentum)) /
                              (static_cast<double>(sum.mass) * 1048576.0));
  };
  return {part(sum.x), part(sum.y), part(sum.z)};
}

/// How a cell and level came to its value; stored in w.
constexpr float value_unknown = 0;
constexpr float value_borrowed = 1;  ///< of the frame before, or of other levels
constexpr float value_measured = 2;  ///< particles of this level were there

/// Eight cell centres round a place, clamped at the grid's borders, and their weights.
struct CellCorners {
  int cell[8];
  float weight[8];
};

/// The cells as kernels see them. Index of (level, cell): level x cells + cell.
struct GridFrame {
  CellFrame frame;
  CellBlock block;

  SIM_FN int cells() const { return block.size(); }
  SIM_FN int clamped(float at, int n) const {
    return static_cast<int>(at_most(at_least(floorf(at), 0.0f), static_cast<float>(n - 1)));
  }
  /// The cell that holds x, or the nearest one.
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

/// Weighted mean over the corners that have a value; w of the result is 0 when none has.
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

/// The particles that the grids are sums over.
using MovingView = Reads<Column::Position, Column::Velocity, Column::Level>;

/// Whose momentum a sum holds. Resting and Solved are values of Active; All asks nobody for theirs.
enum class Whose : std::uint8_t { Resting = 0, Solved = 1, All = 254, Nobody = 255 };

/// One sum: whose, over which cells.
struct MomentumOf {
  Whose whose = Whose::Nobody;
  GridFrame grid{};
  const int* cell_of = nullptr;  ///< cell of each particle; nullptr: by position
};

/// Mass and momentum by cell and level, several sums at a time.
class CellMomentum {
 public:
  static constexpr int most = 4;

  /// Makes these sums, and forgets those before, in one launch. active: may be nullptr where no sum asks.
  template <int n>
  void measure(MovingView particles, const std::uint8_t* active, const MomentumOf (&sums)[n]) {
    static_assert(n <= most);
    measure(particles, active, sums, n);
  }
  /// The k-th sum: [level x cells + cell]; nullptr when it is Nobody's. It lasts until the next measure() or
  /// reserve().
  const MomentumSum* of(int k) const { return of_[k]; }
  /// Makes room for sums over `cells` in all.
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

/// Turns sums into means and fills what is empty.
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

class VelocityGrid {
 public:
  /// Lays cells of `edge` over the domain: ceil(extent / edge), at least one each way. Forgets all values
  /// when the cells change.
  void fit(const Domain& domain, float edge);
  GridFrame frame() const { return {frame_, block_}; }
  int cells() const { return block_.size(); }

  /// The pass that makes V of a sum over frame(): mass-weighted mean velocity of a cell and level, m/s. What
  /// is empty keeps the measured value of the frame before, once, or takes the mean of the other levels.
  /// Without a sum (nullptr) V stays.
  Pass<FinishVelocity> finish_velocity(const MomentumSum* sums) {
    return {sums ? grid_levels * cells() : 0, {sums, velocity_.data(), cells()}};
  }
  /// E: kinetic energy of a cell, all particles, in m_* m2/s2 (J per kg of m_*).
  void update_energy(MovingView particles);

  const Array<Vec4>& velocity() const { return velocity_; }
  const Array<float>& energy() const { return energy_; }
  std::size_t bytes() const;
  /// What outlives a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(frame_, block_, velocity_, energy_);
    if constexpr (Archive::reads) make_energy_sums();
  }

 private:
  void make_energy_sums();

  CellFrame frame_;
  CellBlock block_;
  Array<std::uint64_t> energy_sums_;  ///< zero whenever nobody adds
  Array<Vec4> velocity_;
  Array<float> energy_;
};

}  // namespace sim::SIM_BACKEND
