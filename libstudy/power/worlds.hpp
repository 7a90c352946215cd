#pragma once
/// The assumed truth of a simulated study.

#include <string>
#include <vector>

#include "libstudy/power/request.hpp"
#include "libstudy/power/shown.hpp"

namespace study {

/// One assumed truth, and the hypotheses evaluated under it.
struct Scenario {
  std::vector<std::string> hypotheses;    ///< "H1", ...
  std::vector<double> realism, sickness;  ///< Task 1: mean answer by n_* and method, row after row
  std::vector<double> preferred;          ///< Task 2: methods by methods, P(row is chosen over column)
};

struct World {
  std::string id;     ///< "effect", "null", "margin" or "paper"
  std::string words;  ///< what it assumes, in words
  std::vector<Scenario> scenarios;
};

/// Worlds as PowerRequest::worlds names them; Task 1 or 2. base::Error if a world needs an effect that was
/// not given, or the design has an n_* that the paper does not have.
std::vector<World> make_worlds(const PowerRequest& request, const ShownFactors& factors);

}  // namespace study
