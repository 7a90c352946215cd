#pragma once
/// What is true in a simulated study.

#include <string>
#include <vector>

#include "apps/stats/power/request.hpp"
#include "apps/stats/power/shown.hpp"

namespace apps {

/// One truth, and the hypotheses whose decisions are judged in it.
struct Scenario {
  std::vector<std::string> hypotheses;    ///< "H1", ...
  std::vector<double> realism, sickness;  ///< Task 1: mean answer by n_* and method, row after row
  std::vector<double> preferred;          ///< Task 2: methods by methods, P(row is chosen over column)
};

struct World {
  std::string id;     ///< "effect", "null", "margin" or "paper"
  std::string words;  ///< what it holds to be true
  std::vector<Scenario> scenarios;
};

/// Worlds as PowerRequest::worlds names them; Task 1 or 2. base::Error for an effect that the world needs and
/// that was not given, and for a design whose n_* the paper does not have.
std::vector<World> make_worlds(const PowerRequest& request, const ShownFactors& factors);

}  // namespace apps
