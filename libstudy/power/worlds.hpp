#pragma once
/// The true effects that are assumed for simulated studies.

#include <string>
#include <vector>

#include "libstudy/power/request.hpp"
#include "libstudy/power/shown.hpp"

namespace study {

/// Assumed true means or preferences, and the hypotheses that are tested under them.
struct Scenario {
  std::vector<std::string> hypotheses;    ///< ids of hypotheses about methods, or "effects"
  std::vector<double> realism, sickness;  ///< Task 1: mean answers, row-major: row n_*, column method
  std::vector<double> preferred;          ///< Task 2: P(row's method is chosen over column's), row-major
};

struct World {
  /// "effect" (effects as requested), "null" (none), "margin" (as large as the plan's margins) or "paper".
  std::string id;
  std::string words;  ///< the world's assumptions in words
  std::vector<Scenario> scenarios;
};

/// The worlds named in PowerRequest::worlds, for Task 1 or 2. base::Error if world "effect" is requested
/// without an effect, if world "paper" is requested for an n_* that the paper lacks, if world "margin" does
/// not fit the plan's hypotheses, if the world cannot be simulated for levels of effects, or if the protocol
/// varies effects without level none.
std::vector<World> make_worlds(const PowerRequest& request, const ShownFactors& factors);

}  // namespace study
