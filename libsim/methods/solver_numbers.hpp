#pragma once
/// Numbers of the solver that a program may set.

#include <span>
#include <string>
#include <type_traits>
#include <variant>

namespace sim {

// Numbers with a measured default (docs/decisions.md), one row each: NUMBER(type, member, option of programs
// without "--", default, least, most, meaning with its unit). A row defines a member of SolverNumbers, a
// member of SolverParameters, which stages read, an option of programs, and a part of the keys of settled
// states and saved runs. relaxation: one number for all levels, epsilon_i = relaxation / (m_i d_i^2), with
// the mass m_i and the diameter d_i of particle i. tensile: s_ij = -tensile m_i m_j d^2 (W / W(0.2 h))^4 for
// a pair i, j with the kernel W, the mean diameter d and the mean support h; with 0 the solver runs kernels
// without this term. momentum: in a substep's first projection it counts as 0. coarse_cycles: 0 omits the
// coarse pressure. coarse_edge: wanted edge of the cells; the actual edge is adjusted so that a whole number
// of cells fits between the walls.
#define SIM_SOLVER_NUMBERS(NUMBER)                                                                   \
  NUMBER(float, relaxation, "relaxation", 0.01f, 0, 100, "Constraint relaxation")                    \
  NUMBER(float, tensile, "tensile", 0, 0, 100, "s_corr strength")                                    \
  NUMBER(float, momentum, "momentum", 0.4f, 0, 100,                                                  \
         "Factor of the last projection's step that is taken again")                                 \
  NUMBER(float, still_speed, "still-speed", 0.15f, 0, 10,                                            \
         "Speed below which water counts as still and is calmed, in sqrt(g d); 0 = never")           \
  NUMBER(int, coarse_cycles, "coarse-cycles", 2, 0, 16, "V-cycles of the coarse pressure; 0 = none") \
  NUMBER(float, coarse_edge, "coarse-edge", 2, 0.5, 8, "Edge of the coarse pressure's cells, in h")

/// Numbers of the solver that a program sets. A member that still has the value given here is not set. The
/// solver then chooses the number of substeps by the water's speed, uses the measured defaults of the members
/// of SIM_SOLVER_NUMBERS, and the scene's values of the others.
struct SolverNumbers {
  static constexpr int most_iterations = 64;
  static constexpr int most_fixed_substeps = 64;  ///< largest value of the programs' option "substeps"
  int iterations = 0;                             ///< constraint projections per substep; 0 = the scene's
  int substeps = 0;            ///< per frame; 0 = as many as the fastest particle needs (scene.hpp)
  int most_substeps = 0;       ///< limit per frame if substeps is 0; 0 = 32, or the scene's minimum if larger
  double frame_dt_s = 0;       ///< 0 = the scene's
  double viscosity_m2_s = -1;  ///< negative = the scene's
  double courant = -1;         ///< longest move of a particle per substep, in h; negative = the scene's
#define SIM_WISH(Type, member, ...) std::conditional_t<std::is_same_v<Type, int>, int, double> member = -1;
  SIM_SOLVER_NUMBERS(SIM_WISH)
#undef SIM_WISH
};

/// Describes one member of SolverNumbers.
struct SolverNumber {
  const char* name;    ///< name of the programs' option, without "--"
  const char* help;    ///< meaning, unit and default
  double least, most;  ///< allowed values
  std::variant<int SolverNumbers::*, double SolverNumbers::*> value;
};
/// Descriptions of all members of SolverNumbers. Programs derive their options from this list, and the keys
/// of settled states and saved runs contain its numbers.
std::span<const SolverNumber> solver_numbers();
/// All numbers as text, " iterations=4 ...", without rounding: equal texts mean equal numbers.
std::string in_words(const SolverNumbers& numbers);

}  // namespace sim
