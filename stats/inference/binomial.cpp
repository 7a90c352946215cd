#include "stats/inference/binomial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "stats/inference/distributions.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

using Interval = std::array<double, 2>;

struct Count {
  double k, n, p, q;  ///< q = 1 - p
};

/// The largest whole number in [low, high] for which `holds` is true; low - 1 if it never is. `holds` must be
/// true up to some number and false beyond it.
template <class Predicate>
double last_where(double low, double high, const Predicate& holds) {
  double good = low - 1;
  while (good < high) {
    const double middle = std::floor((good + high + 1) / 2);
    if (holds(middle))
      good = middle;
    else
      high = middle - 1;
  }
  return good;
}

/// Two-sided p: the sum of the probabilities of all counts that are at most as probable as k.
double two_sided(const Count& c) {
  if (c.p == 0 || c.q == 0) return c.k == (c.p == 0 ? 0 : c.n) ? 1 : 0;
  const double mean = c.n * c.p;
  if (c.k == mean) return 1;
  const double observed = log_binomial_mass(c.k, c.n, c.p, c.q) + std::log1p(1e-7);
  const auto likelier = [&](double j) { return log_binomial_mass(j, c.n, c.p, c.q) > observed; };
  double lower = c.k, upper = c.k;
  if (c.k < mean) {
    upper = last_where(std::ceil(mean), c.n, likelier) + 1;
  } else {
    lower = -last_where(-std::floor(mean), 0, [&](double j) { return likelier(-j); }) - 1;
  }
  const double below = log_binomial_lower(lower, c.n, c.p, c.q);
  const double above =
      upper > c.n ? -std::numeric_limits<double>::infinity() : log_binomial_upper(upper, c.n, c.p, c.q);
  const double larger = std::max(below, above);
  return probability(std::min(0.0, larger + std::log1p(std::exp(std::min(below, above) - larger))));
}

double exact_p(const Count& c, Alternative side) {
  if (side == Alternative::TwoSided) return two_sided(c);
  return probability(side == Alternative::Less ? log_binomial_lower(c.k, c.n, c.p, c.q)
                                               : log_binomial_upper(c.k, c.n, c.p, c.q));
}

double mid_p(const Count& c, Alternative side) {
  const double half = std::exp(log_binomial_mass(c.k, c.n, c.p, c.q)) / 2;
  const double below = std::exp(log_binomial_lower(c.k - 1, c.n, c.p, c.q)) + half;
  const double above = std::exp(log_binomial_upper(c.k + 1, c.n, c.p, c.q)) + half;
  if (side == Alternative::Less) return std::min(1.0, below);
  if (side == Alternative::Greater) return std::min(1.0, above);
  return std::min(1.0, 2 * std::min(below, above));
}

Interval clopper_pearson(double k, double n, double tail) {
  return {k == 0 ? 0 : beta_quantile(tail, k, n - k + 1), k == n ? 1 : beta_quantile(1 - tail, k + 1, n - k)};
}

Interval jeffreys(double k, double n, double tail) {
  return {k == 0 ? 0 : beta_quantile(tail, k + 0.5, n - k + 0.5),
          k == n ? 1 : beta_quantile(1 - tail, k + 0.5, n - k + 0.5)};
}

Interval wilson(double k, double n, double z) {
  const double share = k / n, z2 = z * z;
  const double centre = k + z2 / 2, reach = z * std::sqrt(n * share * (1 - share) + z2 / 4);
  return {k == 0 ? 0 : (centre - reach) / (n + z2), k == n ? 1 : (centre + reach) / (n + z2)};
}

Interval wilson_corrected(double k, double n, double z) {
  const double share = k / n, z2 = z * z, variance = 4 * share * (1 - share) * n;
  const double shift = 4 * share - 2;
  const auto reach = [&](double sign) { return 1 + z * std::sqrt(z2 - 1 / n + variance + sign * shift); };
  return {k == 0 ? 0 : std::max(0.0, (2 * k + z2 - reach(1)) / (2 * (n + z2))),
          k == n ? 1 : std::min(1.0, (2 * k + z2 + reach(-1)) / (2 * (n + z2)))};
}

Interval agresti_coull(double k, double n, double z) {
  const double trials = n + z * z, share = (k + z * z / 2) / trials;
  const double reach = z * std::sqrt(share * (1 - share) / trials);
  return {share - reach, share + reach};
}

/// Opens the interval on the side that a one-sided alternative does not bound.
Interval one_sided(Interval both, Alternative side) {
  if (side == Alternative::Less) both[0] = 0;
  if (side == Alternative::Greater) both[1] = 1;
  return both;
}

std::string why_not(double k, double n, double p0) {
  if (std::isnan(k) || std::isnan(n) || std::isnan(p0)) return "a missing count or proportion";
  if (n != std::floor(n) || k != std::floor(k)) return "counts must be whole numbers";
  if (n < 1) return "no trials";
  if (n > 1e9) return "more than 1e9 trials";
  if (k < 0) return "a negative count";
  if (k > n) return "more successes than trials";
  if (!(p0 >= 0 && p0 <= 1)) return "the proportion under the null must lie in [0, 1]";
  return {};
}

}  // namespace

Result<BinomialTest> binomial_test(double k, double n, double p0, Alternative alternative,
                                   double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument(
        "binomial_test: the confidence is not between 0 and 1; give one such as 0.95");
  if (const std::string reason = why_not(k, n, p0); !reason.empty()) return Refusal{reason};

  BinomialTest out{.k = k, .n = n, .p0 = p0, .alternative = alternative, .confidence = confidence};
  const Count count{k, n, p0, 1 - p0};
  out.estimate = k / n;
  out.p = exact_p(count, alternative);
  out.p_mid = mid_p(count, alternative);

  const double tail = alternative == Alternative::TwoSided ? (1 - confidence) / 2 : 1 - confidence;
  const double z = -normal_quantile(tail);
  out.clopper_pearson = one_sided(clopper_pearson(k, n, tail), alternative);
  out.jeffreys = one_sided(jeffreys(k, n, tail), alternative);
  out.wilson = one_sided(wilson(k, n, z), alternative);
  out.wilson_cc = one_sided(wilson_corrected(k, n, z), alternative);
  out.agresti_coull = one_sided(agresti_coull(k, n, z), alternative);

  out.cohen_g = out.estimate - p0;
  out.cohen_h = 2 * std::asin(std::sqrt(out.estimate)) - 2 * std::asin(std::sqrt(p0));
  return out;
}

double binomial_p(double k, double n, double p0, Alternative alternative) {
  if (const std::string reason = why_not(k, n, p0); !reason.empty()) throw std::invalid_argument(reason);
  return exact_p({k, n, p0, 1 - p0}, alternative);
}

}  // namespace stats
