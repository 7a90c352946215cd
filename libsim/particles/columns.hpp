#pragma once
/// The columns that a particle can have: one table, and sets of them.

#include <bit>
#include <cstdint>

#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// f_a, f_m, f_T and F (ViP-Fluid Eq. 1-6) of the eye with the larger F.
struct SaliencyParts {
  float acuity, manifold, temporal, combined;
};

/// How long a column's values live.
enum class Life {
  Core,    ///< with their particle, in every run
  Kept,    ///< with their particle, where a stage declares them
  Scratch  ///< within a substep
};

/// What the particles that a split or a merge makes have of a column (particles/descent.hpp). The last four
/// need no line anywhere else: such columns begin at 0, where no pass says otherwise, and splits, merges and
/// nozzles treat them by their rule.
enum class Descent {
  None,      ///< nothing: the column is scratch
  Own,       ///< what the passes that split, merge and pour say by its name
  Copy,      ///< children have their parent's; a merged particle keeps what the one that stays had
  MassMean,  ///< children have their parent's; a merged particle the mean by mass: m times it is conserved
  Sum,       ///< children share their parent's by mass, a merged particle has the sum: it is conserved
  Max,       ///< children have their parent's, a merged particle the larger
  Reset      ///< 0
};

// The table, a row each: COLUMN(enumerator, member, type of a value, how long it lives, what splits and
// merges make of it), in the order in which schedules list them. LIST is the neighbour list
// (neighbors/neighbour_list.hpp), which passes declare like a column.
//
//   Position        x, y, z in m and the support radius h in m (h = 2 d = 4 r; mass = rho_0 d^3)
//   Velocity        m/s, w unused
//   Id              unique, kept for life
//   Level           mass level; mass = 2^level m_*
//   Predicted       position at the end of the substep as far as it is solved, and h
//   PredictedNext   where a projection writes, then swapped with Predicted; the substep's kicks; of effects
//   VelocityNext    where a velocity filter writes, then swapped with Velocity; later of effects
//   Lambda          change of the density constraint's multiplier in this projection, kg m2
//   Density         rho / rho_0, walls included
//   Target          level that the particle should have
//   History         targets of the last four frames, two bits each, the newest lowest
//   Saliency        s in [0, 1], ViP-Fluid 3.2.3
//   Unrest          f_T gamma_t of ViP-Fluid Eq. 6, followed over frames
//   SaliencyParts   f_a, f_m, f_T and F behind it
//   Waiting         frames in a row that it has been ready to merge
//   Normal          of the surface, inwards, without unit; scratch of the effects (libsim/scene/effects.hpp)
//   Ease            share of its constraint that a particle near a fresh one enforces, (0, 1]
//   Age             frames since it was made by a split or a merge, 255 and more are one
//   Active          1 = solved in this frame, 2 = the same and left out of means (activation/activation.hpp),
//                   0 = moved by the velocity grid (ViP-Fluid, Algorithm 3)
//   Rest            why and how long it was not solved (activation/activation.hpp)
//   StartCell       where in the velocity grid the particle was when the frame began
//   Temperature     kelvin above the reference of the effect that keeps it
//   TemperatureNext where conduction writes, then swapped with Temperature
//   Swirl           how fast the water round it turns, 1/s, as the effect vorticity last found it
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
  COLUMN(Rest, rest, std::uint8_t, Kept, Copy)                            \
  COLUMN(StartCell, start_cell, int, Kept, Copy)                          \
  COLUMN(Temperature, temperature, float, Kept, MassMean)                 \
  COLUMN(TemperatureNext, temperature_next, float, Scratch, None)         \
  COLUMN(Swirl, swirl, float, Kept, MassMean)

enum class Column : unsigned {
#define SIM_ENUMERATOR(Name, ...) Name,
  SIM_COLUMNS(SIM_ENUMERATOR, SIM_ENUMERATOR)
#undef SIM_ENUMERATOR
      count
};

const char* column_name(Column column);

/// A set of columns that is known at compile time where a stage declares it.
struct ColumnSet {
  std::uint32_t bits = 0;

  constexpr bool has(Column column) const { return bits >> static_cast<unsigned>(column) & 1u; }
  constexpr bool holds(ColumnSet other) const { return (other.bits & ~bits) == 0; }
  constexpr bool meets(ColumnSet other) const { return (other.bits & bits) != 0; }
  constexpr bool empty() const { return bits == 0; }
  /// The first in the table's order; the set is not empty.
  constexpr Column first() const { return static_cast<Column>(std::countr_zero(bits)); }

  friend constexpr ColumnSet operator|(ColumnSet a, ColumnSet b) { return {a.bits | b.bits}; }
  /// Those of a that b lacks.
  friend constexpr ColumnSet operator-(ColumnSet a, ColumnSet b) { return {a.bits & ~b.bits}; }
  constexpr ColumnSet& operator|=(ColumnSet other) { return *this = *this | other; }
};
static_assert(static_cast<unsigned>(Column::count) <= 32);

template <class... Columns>
constexpr ColumnSet columns(Columns... which) {
  return {((std::uint32_t{1} << static_cast<unsigned>(which)) | ... | std::uint32_t{0})};
}
constexpr ColumnSet all_columns() { return {(std::uint32_t{1} << static_cast<unsigned>(Column::count)) - 1}; }

}  // namespace sim::SIM_BACKEND
