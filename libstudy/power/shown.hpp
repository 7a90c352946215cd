#pragma once
/// The protocol's plan of trials for each participant, reduced to the fields that an analysis uses.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/factor_levels.hpp"

namespace study {

/// The factors of a design, in file order.
struct ShownFactors {
  explicit ShownFactors(const Design& design);

  struct Place {
    int scene = 0, n_star = 0, method = 0;
  };
  std::vector<std::string> scenes, n_stars;
  std::vector<std::string> methods;            ///< with their level if effects are a factor: treatment_name()
  std::vector<Place> cells;                    ///< as Design::cells
  std::vector<std::string> effects;            ///< levels of the factor; empty if effects are not a factor
  std::vector<stats::FactorPlace> treatments;  ///< of `methods`: level of effects, and method
};

struct ShownTrial {
  int participant = 0;  ///< 0-based
  int first = 0;        ///< cell
  int second = -1;      ///< cell of the second interval, or -1
  int position = 0;
  int period = 0;  ///< as stats::MethodScore::period
};

/// Trials of blocks of kind stimulus for n participants. They take the assignment's slots in turn, each with
/// the plan that `vip-study run` would make with this seed. The first m of n participants form a study of m.
std::vector<ShownTrial> planned_trials(const Protocol& protocol, std::uint64_t seed, int n);

}  // namespace study
