#include "stats/ptpe/solver_interval.hpp"

#include <algorithm>

namespace stats {

namespace {

std::array<double, 2> over(const std::array<double, 2>& x, const std::array<double, 2>& y) {
  return {std::min(x[0], y[0]), std::max(x[1], y[1])};
}

}  // namespace

SolverInterval solver_interval(const CurveSpread& direct, const Result<PilotSpread>& contour) {
  if (!contour) return {direct.a_ci, direct.b_ci, false};
  return {over(direct.a_ci, contour->a_ci), over(direct.b_ci, contour->b_ci), true};
}

}  // namespace stats
