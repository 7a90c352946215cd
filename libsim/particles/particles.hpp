#pragma once
/// Particles as a structure of arrays. A column has memory only while a stage declares it.

#include <array>
#include <bitset>
#include <cstdint>

#include "libsim/exec/vec.hpp"

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

/// What the guards met; each field counts one rule (sim::GuardCounts gives them to programs).
struct Guards {
  std::uint64_t speed_limited;
  std::uint64_t coincident_pairs;
  std::uint64_t not_finite;
  std::uint64_t neighbours_dropped;
  std::uint64_t wall_projected;
};

/// n particles in the grid's order.
class Particles {
 public:
  /// Gives each column of the set room for n particles and frees the others.
  void allocate(ColumnSet set, int n);
  int size() const { return n_; }
  /// Bytes held by all columns.
  std::size_t bytes() const;

  Array<Vec4> position, velocity, predicted, predicted_next, velocity_next;
  Array<int> id;
  Array<std::uint8_t> level;
  Array<float> lambda, density;

  /// Permutes the columns that outlive a substep: new[i] = old[order[i]].
  void reorder(const Array<int>& order);

 private:
  int n_ = 0;
  ColumnSet set_;
  // Targets of the permutation, swapped with the columns.
  Array<Vec4> spare_a_, spare_b_, spare_c_;
  Array<int> spare_id_;
  Array<std::uint8_t> spare_level_;
};

}  // namespace sim::SIM_BACKEND
