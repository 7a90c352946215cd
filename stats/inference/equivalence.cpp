#include "stats/inference/equivalence.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/inference/distributions.hpp"
#include "stats/inference/t_test.hpp"

namespace stats {

namespace {

TTestOptions options(double alpha) {
  if (!(alpha > 0 && alpha < 0.5))
    throw std::invalid_argument("equivalence_paired: alpha is not between 0 and 1/2; give one such as 0.05");
  return {.confidence = 1 - 2 * alpha, .effect_intervals = false};
}

void require_order(const Margins& margins) {
  if (!std::isfinite(margins.low) || !std::isfinite(margins.high) || !(margins.low < margins.high))
    throw std::invalid_argument(
        "equivalence_paired: the margins are not finite or in the wrong order; give finite ones with low < "
        "high");
}

/// Both one-sided tests, from the t test against a difference of zero.
EquivalenceTest against(const PairedTTest& test, const Margins& margins, double alpha) {
  EquivalenceTest out;
  out.stderr_estimate = test.stderr_estimate;
  out.estimate = test.t * test.stderr_estimate;
  out.df = test.df;
  out.t_lower = test.t - margins.low / test.stderr_estimate;
  out.t_upper = test.t - margins.high / test.stderr_estimate;
  out.p_lower = student_upper(out.t_lower, out.df);
  out.p_upper = student_lower(out.t_upper, out.df);
  out.p = std::max(out.p_lower, out.p_upper);
  const double reach = student_upper_quantile(alpha, out.df);
  out.ci = {(test.t - reach) * test.stderr_estimate, (test.t + reach) * test.stderr_estimate};
  out.n = test.n;
  out.n_missing = test.n_missing;
  return out;
}

}  // namespace

Result<EquivalenceTest> equivalence_paired(std::span<const double> x, std::span<const double> y,
                                           Margins margins, double alpha) {
  require_order(margins);
  const auto test = t_test_paired(x, y, options(alpha));
  if (!test) return Refusal{test.reason()};
  return against(*test, margins, alpha);
}

}  // namespace stats
