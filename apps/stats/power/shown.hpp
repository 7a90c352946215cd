#pragma once
/// Who is shown what: the protocol's own plan, reduced to what an analysis knows of a trial.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/factor_levels.hpp"

namespace apps {

/// The factors of a design, in file order.
struct ShownFactors {
  explicit ShownFactors(const study::Design& design);

  struct Place {
    int scene = 0, n_star = 0, method = 0;
  };
  std::vector<std::string> scenes, n_stars;
  std::vector<std::string> methods;  ///< where effects are a factor, with their level: treatment_name()
  std::vector<Place> cells;          ///< as Design::cells
  std::vector<std::string> effects;  ///< levels of the factor; empty: effects are none
  std::vector<stats::FactorPlace> treatments;  ///< of `methods`: level of effects, and method
};

struct ShownTrial {
  int participant = 0;  ///< 0-based
  int first = 0;        ///< cell
  int second = -1;      ///< cell of the second interval, or -1
  int position = 0;
  int period = 0;  ///< as stats::MethodScore::period
};

/// Trials of blocks of kind stimulus for n participants who take the assignment's slots in turn, each with
/// the plan that `vip-study run` would make with this seed. The first m of n participants are a study of m.
std::vector<ShownTrial> planned_trials(const study::Protocol& protocol, std::uint64_t seed, int n);

}  // namespace apps
