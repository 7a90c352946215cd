#pragma once
/// Plans the trials of simulated participants, reduced to the fields that an analysis uses.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/factor_levels.hpp"

namespace study {

/// The levels of a design's factors, in the order of the protocol's file.
struct ShownFactors {
  explicit ShownFactors(const Design& design);

  /// Indices into scenes, n_stars and methods.
  struct Place {
    int scene = 0, n_star = 0, method = 0;
  };
  std::vector<std::string> scenes, n_stars;
  std::vector<std::string> methods;  ///< treatment_name(), such as "Ours" or "Ours, foam"
  std::vector<Place> cells;          ///< scene, n_* and method of each of Design::cells
  std::vector<std::string> effects;  ///< levels of the factor effects; empty: no such factor
  /// For each of `methods`: `level` is its index in `effects`, `rest` the number of its method without the
  /// level of effects. Empty if effects are not a factor.
  std::vector<stats::FactorPlace> treatments;
};

struct ShownTrial {
  int participant = 0;  ///< number of the participant, from 0
  int first = 0;        ///< index in Design::cells of the only or first stimulus
  int second = -1;      ///< index in Design::cells of the second stimulus of a pair, or -1
  int position = 0;     ///< place in the order of the session's trials, from 0
  int period = 0;       ///< run of successive trials with one scene and one n_*, from 0; stats::periods_of()
};

/// Trials of the blocks of kind stimulus for n participants. Participants take the slots (combinations of
/// groups and orders over which the protocol balances participants) in turn, and each has the plan that
/// `vip-study run` makes with this seed. The plan of a participant does not depend on n.
std::vector<ShownTrial> planned_trials(const Protocol& protocol, std::uint64_t seed, int n);

}  // namespace study
