#include "libsim/methods/solver_numbers.hpp"

#include <array>
#include <sstream>
#include <utility>

namespace sim {

namespace {

struct AnyNumber {
  template <typename T>
  operator T() const;
};
/// True if SolverNumbers has at least as many members as there are indices.
template <std::size_t... I>
constexpr bool as_many_members(std::index_sequence<I...>) {
  return requires { SolverNumbers{(static_cast<void>(I), AnyNumber{})...}; };
}

}  // namespace

std::span<const SolverNumber> solver_numbers() {
  static constexpr auto all = std::to_array<SolverNumber>(
      {{"iterations", "Projections a substep; 0 = the scene's", 0, SolverNumbers::most_iterations,
        &SolverNumbers::iterations},
       {"substeps", "Substeps in every frame; 0 = as many as the fastest particle needs", 0,
        SolverNumbers::most_fixed_substeps, &SolverNumbers::substeps},
       {"most-substeps",
        "Most substeps in a frame, where the fastest particle decides; 32 or the scene's least when left out",
        1, 1000, &SolverNumbers::most_substeps},
       {"dt", "Frame step in s; the scene's when left out", 1e-5, 1, &SolverNumbers::frame_dt_s},
       {"viscosity", "Kinematic viscosity in m2/s; the scene's when left out", 0, 1e3,
        &SolverNumbers::viscosity_m2_s},
       {"courant", "Longest way of the fastest particle in a substep, in h; the scene's when left out", 0.05,
        4, &SolverNumbers::courant},
#define SIM_ROW(Type, member, name, usual, least, most, meaning) \
  {name, meaning, least, most, &SolverNumbers::member},
       SIM_SOLVER_NUMBERS(SIM_ROW)
#undef SIM_ROW
      });
  static_assert(as_many_members(std::make_index_sequence<all.size()>{}) &&
                    !as_many_members(std::make_index_sequence<all.size() + 1>{}),
                "each member of SolverNumbers has one row");
  return all;
}

std::string in_words(const SolverNumbers& numbers) {
  std::ostringstream out;
  out << std::hexfloat;
  for (const SolverNumber& number : solver_numbers())
    std::visit([&](auto member) { out << ' ' << number.name << '=' << numbers.*member; }, number.value);
  return out.str();
}

}  // namespace sim
