#pragma once
/// The columns that particles can have: one table, and sets of columns.

#include <bit>
#include <cstdint>
#include <type_traits>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// f_a, f_m, f_T and F (ViP-Fluid Eq. 1-6) for the eye with the larger F.
struct SaliencyParts {
  float acuity, manifold, temporal, combined;
};

/// Lifetime of a column's values.
enum class Life {
  Core,    ///< values last as long as the particle; the column exists in every run
  Kept,    ///< values last as long as the particle; the column exists if a stage declares it
  Scratch  ///< values last until the particles are next reordered
};

/// Rule for a column's values when a split or a merge makes particles. MassMean, Sum, Max and Reset need no
/// other code: splits and merges apply them, new particles from nozzles get 0, and their columns start at 0
/// unless other code sets them (Age starts at 255).
enum class Descent {
  None,  ///< no values: the column is scratch
  Own,   ///< set by the passes that split, merge and add particles
  Copy,  ///< children copy the parent's value; a merged particle keeps the value of one of the two
  /// children copy the parent's value; a merged particle gets the mean by mass: mass x value is conserved
  MassMean,
  /// each of n children gets 1 / n of the parent's value; a merged particle gets the sum: the total is
  /// conserved
  Sum,
  Max,   ///< children copy the parent's value; a merged particle gets the larger value
  Reset  ///< every child and every merged particle gets 0
};

// The table of columns. Each row is COLUMN(enumerator, member, value type, lifetime, rule for splits and
// merges), in the order in which schedules list them. LIST is the neighbour list
// (neighbors/neighbour_list.hpp), which passes declare like a column.
//
//   Position        x, y, z in m and the support radius h in m (h = 2 d = 4 r; mass = rho_0 d^3)
//   Velocity        m/s, w unused
//   Id              unique, never changes
//   Level           mass level; mass = 2^level m_*
//   Predicted       present estimate of the position at the substep's end, m, and h
//   PredictedNext   output of a projection, then swapped with Predicted; later in the substep the velocity
//                   change by the projections, and scratch of effects
//   VelocityNext    output of a velocity filter, then swapped with Velocity; later scratch of effects
//   Lambda          change of the density constraint's multiplier in the present projection, kg m2
//   Density         rho / rho_0, walls included
//   Target          level that the particle should have
//   History         targets of the last four frames, two bits each, the newest lowest
//   Saliency        s in [0, 1], ViP-Fluid 3.2.3
//   Unrest          temporal feature before occlusion, f_T gamma_t of ViP-Fluid Eq. 6, smoothed over frames
//   SaliencyParts   f_a, f_m, f_T and F, from which s follows
//   Waiting         number of consecutive frames in which the particle was ready to merge
//   Normal          output of the average Drift, then swapped with it; later scratch of the effects
//                   (libsim/scene/effects.hpp): normal of the water's surface, dimensionless, or another
//                   vector
//   Ease            share (0, 1] of the density constraint that a particle enforces; below 1 near particles
//                   that a split or a merge has just made
//   Age             frames since a split, a merge or a nozzle made the particle, at most 255; starts at 255
//   Active          1 = solved in every substep of the frame, 0 = rests (activation/activation.hpp)
//   StartCell       cell of the velocity grid in which the particle started the frame
//   Temperature     kelvin above the reference of the effect heat
//   TemperatureNext output of conduction, then swapped with Temperature
//   Swirl           rotation rate of the surrounding water, 1/s, last measured by the effect vorticity
//   Drift           x, y, z: mean velocity of the water around the particle in the last substeps, m/s; w: the
//                   largest recent squared speed of this mean, m2/s2
#define SIM_COLUMNS(COLUMN, LIST)                                         \
  COLUMN(Position, position, Vec4, Core, Own)                             \
  COLUMN(Velocity, velocity, Vec4, Core, Own)                             \
  COLUMN(Id, id, int, Core, Own)                                          \
  COLUMN(Level, level, std::uint8_t, Core, Own)                           \
  COLUMN(Predicted, predicted, Vec4, Core, Copy)                          \
  COLUMN(PredictedNext, predicted_next, Vec4, Scratch, None)              \
  COLUMN(VelocityNext, velocity_next, Vec4, Scratch, None)                \
  COLUMN(Lambda, lambda, float, Scratch, None)                            \
  COLUMN(Density, density, float, Scratch, None)                          \
  LIST(Neighbours, neighbours)                                            \
  COLUMN(Target, target, std::uint8_t, Kept, Copy)                        \
  COLUMN(History, history, std::uint8_t, Kept, Own)                       \
  COLUMN(Saliency, saliency, float, Kept, Copy)                           \
  COLUMN(Unrest, unrest, float, Kept, Copy)                               \
  COLUMN(SaliencyParts, saliency_parts, struct SaliencyParts, Kept, Copy) \
  COLUMN(Waiting, waiting, std::uint8_t, Kept, Reset)                     \
  COLUMN(Normal, normal, Vec4, Scratch, None)                             \
  COLUMN(Ease, ease, float, Scratch, None)                                \
  COLUMN(Age, age, std::uint8_t, Kept, Reset)                             \
  COLUMN(Active, active, std::uint8_t, Kept, Copy)                        \
  COLUMN(StartCell, start_cell, int, Kept, Copy)                          \
  COLUMN(Temperature, temperature, float, Kept, MassMean)                 \
  COLUMN(TemperatureNext, temperature_next, float, Scratch, None)         \
  COLUMN(Swirl, swirl, float, Kept, MassMean)                             \
  COLUMN(Drift, drift, Vec4, Kept, Copy)

enum class Column : unsigned {
#define SIM_ENUMERATOR(Name, ...) Name,
  SIM_COLUMNS(SIM_ENUMERATOR, SIM_ENUMERATOR)
#undef SIM_ENUMERATOR
      count
};

const char* column_name(Column column);

/// A set of columns; constexpr, because stages declare their columns at compile time.
struct ColumnSet {
  std::uint32_t bits = 0;

  constexpr bool has(Column column) const { return bits >> static_cast<unsigned>(column) & 1u; }
  constexpr bool holds(ColumnSet other) const { return (other.bits & ~bits) == 0; }
  constexpr bool meets(ColumnSet other) const { return (other.bits & bits) != 0; }
  constexpr bool empty() const { return bits == 0; }
  /// The set's first column in the table's order; the set must not be empty.
  constexpr Column first() const { return static_cast<Column>(std::countr_zero(bits)); }

  friend constexpr ColumnSet operator|(ColumnSet a, ColumnSet b) { return {a.bits | b.bits}; }
  /// The columns of a that are not in b.
  friend constexpr ColumnSet operator-(ColumnSet a, ColumnSet b) { return {a.bits & ~b.bits}; }
  constexpr ColumnSet& operator|=(ColumnSet other) { return *this = *this | other; }
};
static_assert(static_cast<unsigned>(Column::count) <= 32);

template <class... Columns>
constexpr ColumnSet columns(Columns... which) {
  return {((std::uint32_t{1} << static_cast<unsigned>(which)) | ... | std::uint32_t{0})};
}
constexpr ColumnSet all_columns() { return {(std::uint32_t{1} << static_cast<unsigned>(Column::count)) - 1}; }

/// True for the rules that kernels carry out alike for every column: mean by mass, sum, maximum, reset.
constexpr bool by_rule(Descent rule) {
  return rule == Descent::MassMean || rule == Descent::Sum || rule == Descent::Max || rule == Descent::Reset;
}

/// True if a column of type T may have this lifetime and rule: scratch columns have no rule and all others
/// have one. Of the rules of by_rule(), a float column may have each, a byte column Max and Reset, and
/// columns of other types none.
template <class T>
constexpr bool may_descend(Life life, Descent rule) {
  if ((life == Life::Scratch) != (rule == Descent::None)) return false;
  if (!by_rule(rule) || std::is_same_v<T, float>) return true;
  return std::is_same_v<T, std::uint8_t> && (rule == Descent::Max || rule == Descent::Reset);
}
#define SIM_CHECK(Name, member, Type, life, rule) \
  static_assert(may_descend<Type>(Life::life, Descent::rule), #Name " cannot split and merge so");
#define SIM_NOTHING(...)
SIM_COLUMNS(SIM_CHECK, SIM_NOTHING)
#undef SIM_CHECK

/// kept_count: the number of Kept columns of type T. ruled_count: the number of columns of type T whose rule
/// by_rule() accepts.
template <class T>
constexpr int kept_count() {
  int sum = 0;
#define SIM_COUNT(Name, member, Type, life, rule) sum += std::is_same_v<Type, T> && Life::life == Life::Kept;
  SIM_COLUMNS(SIM_COUNT, SIM_NOTHING)
#undef SIM_COUNT
  return sum;
}
template <class T>
constexpr int ruled_count() {
  int sum = 0;
#define SIM_COUNT(Name, member, Type, life, rule) sum += std::is_same_v<Type, T> && by_rule(Descent::rule);
  SIM_COLUMNS(SIM_COUNT, SIM_NOTHING)
#undef SIM_COUNT
  return sum;
}

/// All columns whose values splits and merges compute by rule (by_rule(): mean by mass, sum, maximum or
/// reset). They have values at the start of a run, so that passes may read them before any pass writes them.
constexpr ColumnSet ruled_columns() {
  ColumnSet out;
#define SIM_ADD(Name, member, Type, life, rule) \
  if (by_rule(Descent::rule)) out |= columns(Column::Name);
  SIM_COLUMNS(SIM_ADD, SIM_NOTHING)
#undef SIM_ADD
#undef SIM_NOTHING
  return out;
}

/// The allocated columns of type T whose rule by_rule() accepts (mean by mass, sum, maximum, reset), with
/// functions that apply the rules.
template <class T>
struct RuledColumns {
  T* values[ruled_count<T>()];
  Descent rule[ruled_count<T>()];
  int count;

  /// Sets the values of particle i, so far a copy of its parent, which splits into `children` equal masses.
  SIM_FN void split(int i, int children) const {
    for (int k = 0; k < count; ++k) {
      if (rule[k] == Descent::Reset) values[k][i] = 0;
      if constexpr (std::is_same_v<T, float>)
        if (rule[k] == Descent::Sum) values[k][i] /= static_cast<float>(children);
    }
  }
  /// Merges the particles `kept` and `left`, of equal mass; the results are in `kept`.
  SIM_FN void join(int kept, int left) const {
    for (int k = 0; k < count; ++k) {
      T* v = values[k];
      v[kept] = met(rule[k], v[kept], v[left], 1);
    }
  }
  /// Merges one half of particle j with `kept`, the other half with `left`; the results are in `kept` and in
  /// j. Particle j has the mass of `kept` and `left` together.
  SIM_FN void share(int j, int kept, int left) const {
    for (int k = 0; k < count; ++k) {
      T* v = values[k];
      const T whole = v[j];
      v[kept] = met(rule[k], v[kept], whole, 0.5f);
      v[j] = met(rule[k], v[left], whole, 0.5f);
    }
  }
  /// Sets the values of a new particle without a parent, such as one from a nozzle, to 0.
  SIM_FN void make(int i) const {
    for (int k = 0; k < count; ++k) values[k][i] = 0;
  }

 private:
  /// New value of a particle of value a that receives an equal mass from a particle of value b; `share`: the
  /// received mass as a share of the second particle's mass.
  SIM_FN static T met(Descent rule, T a, T b, float share) {
    if (rule == Descent::Reset) return 0;
    if (rule == Descent::Max) return a > b ? a : b;
    if constexpr (std::is_same_v<T, float>) return rule == Descent::Sum ? a + share * b : 0.5f * (a + b);
    return a;
  }
};

/// All allocated columns whose rule by_rule() accepts (mean by mass, sum, maximum, reset), of both types.
struct Descents {
  RuledColumns<float> floats;
  RuledColumns<std::uint8_t> bytes;

  SIM_FN void split(int i, int children) const {
    floats.split(i, children);
    bytes.split(i, children);
  }
  SIM_FN void join(int kept, int left) const {
    floats.join(kept, left);
    bytes.join(kept, left);
  }
  SIM_FN void share(int j, int kept, int left) const {
    floats.share(j, kept, left);
    bytes.share(j, kept, left);
  }
  SIM_FN void make(int i) const {
    floats.make(i);
    bytes.make(i);
  }
};

}  // namespace sim::SIM_BACKEND
