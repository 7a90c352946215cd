#pragma once
/// Particles as a structure of arrays. A column has memory only while a stage declares it.

#include <array>
#include <bitset>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "libsim/exec/vec.hpp"
#include "libsim/simulation.hpp"

namespace sim::SIM_BACKEND {

/// All columns that a stage may read or write.
enum class Column : unsigned {
  Position,       ///< Vec4: x, y, z in m and the support radius h in m (h = 2 d = 4 r; mass = rho_0 d^3)
  Velocity,       ///< Vec4: m/s, w unused
  Id,             ///< int: unique, kept for life
  Level,          ///< uint8: mass level; mass = 2^level m_*
  Predicted,      ///< Vec4: position at the end of the substep as far as it is solved, and h
  PredictedNext,  ///< Vec4: where a projection writes, then swapped with Predicted
  VelocityNext,   ///< Vec4: where a velocity filter writes, then swapped with Velocity
  Lambda,         ///< float: change of the density constraint's multiplier in this projection, kg m2
  Density,        ///< float: rho / rho_0, walls included
  Neighbours,     ///< the combined neighbour list (neighbors/neighbour_list.hpp)
  Target,         ///< uint8: level that the particle should have
  History,        ///< uint8: targets of the last four frames, two bits each, the newest lowest
  Saliency,       ///< float: s in [0, 1], ViP-Fluid 3.2.3
  Unrest,         ///< float: f_T gamma_t of ViP-Fluid Eq. 6, followed over frames
  SaliencyParts,  ///< f_a, f_m, f_T and F behind it
  Waiting,        ///< uint8: frames in a row that it has been ready to merge
  Ease,           ///< float: share of its constraint that a particle near a fresh one enforces, (0, 1]
  Age,            ///< uint8: frames since it was made by a split or a merge, 255 and more are one
  Active,     ///< uint8: 1 = solved in this frame, 0 = moved by the velocity grid (ViP-Fluid, Algorithm 3)
  Rest,       ///< uint8: why and how long it was not solved (activation/activation.hpp)
  StartCell,  ///< int: where in the velocity grid the particle was when the frame began
  count
};
using ColumnSet = std::bitset<static_cast<std::size_t>(Column::count)>;

template <class... Columns>
ColumnSet columns(Columns... which) {
  ColumnSet out;
  (out.set(static_cast<std::size_t>(which)), ...);
  return out;
}

const char* column_name(Column column);

/// f_a, f_m, f_T and F (ViP-Fluid Eq. 1-6) of the eye with the larger F.
struct SaliencyParts {
  float acuity, manifold, temporal, combined;
};

/// What the guards met; each field counts one rule (sim::GuardCounts gives them to programs).
struct Guards {
  std::uint64_t speed_limited;
  std::uint64_t coincident_pairs;
  std::uint64_t not_finite;
  std::uint64_t neighbours_dropped;
  std::uint64_t wall_projected;
  std::uint64_t saliency_not_finite;
};

/// Support radius of each mass level, m: cbrt(2^level) h_* (Eq. 10).
struct LevelSupports {
  static constexpr int most = 4;
  float h[most];
};
LevelSupports level_supports(double finest_support);

/// n particles in the grid's order.
class Particles {
 public:
  /// Gives each column of the set room for `capacity` particles (at least n), n of them in use, and frees the
  /// others.
  void allocate(ColumnSet set, int n, int capacity = 0);
  int size() const { return n_; }
  int capacity() const { return capacity_; }
  bool has(Column column) const { return set_.test(static_cast<std::size_t>(column)); }
  /// Sets how many are in use, at most the capacity. Those that stay keep their values.
  void resize(int n);
  /// Bytes held by all columns.
  std::size_t bytes() const;

  Array<Vec4> position, velocity, predicted, predicted_next, velocity_next;
  Array<int> id;
  Array<std::uint8_t> level, target, history, waiting, age, active, rest;
  Array<int> start_cell;
  Array<float> lambda, density, ease, saliency, unrest;
  Array<SaliencyParts> saliency_parts;

  /// Gathers the columns that outlive a substep: new[i] = old[order[i]] for i < order.size(), which becomes
  /// the number of particles. A source may be named more than once (a split) or never (a merge).
  void reorder(const Array<int>& order);

 private:
  /// Gives each column to visit(column, declared), in one fixed order.
  template <class Self, class Visit>
  static void for_each_column(Self& self, Visit visit);
  /// Permutes those of the columns that are declared.
  template <class T>
  void reorder_extras(const Array<int>& order, std::initializer_list<std::pair<Column, Array<T>*>> extras,
                      std::vector<Array<T>>& spares);

  int n_ = 0;
  int capacity_ = 0;
  ColumnSet set_;
  // Targets of the permutation, swapped with the columns.
  Array<Vec4> spare_a_, spare_b_, spare_c_;
  Array<int> spare_id_;
  Array<std::uint8_t> spare_level_;
  std::vector<Array<std::uint8_t>> spare_bytes_;
  std::vector<Array<float>> spare_floats_;
  std::vector<Array<int>> spare_ints_;
  std::vector<Array<SaliencyParts>> spare_parts_;
};

/// sim::ParticleField on the host, in the particles' order; 0 where its column is not there, 1 for Active.
std::vector<float> field_of(const Particles& particles, ParticleField field);

}  // namespace sim::SIM_BACKEND
