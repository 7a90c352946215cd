#include "stats/inference/power.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <numbers>
#include <string>

#include "stats/gsl_errors.hpp"
#include "stats/inference/binomial.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/quantiles.hpp"
#include "stats/root.hpp"

namespace stats {

namespace {

constexpr double most_participants = 1e7;

bool open_unit(double p) { return p > 0 && p < 1; }

double degrees_of_freedom(double n, Design design) {
  return design == Design::TwoSample ? 2 * (n - 1) : n - 1;
}

/// Standard error of the estimated difference, in units of the SD.
double error_per_sd(double n, Design design) { return std::sqrt((design == Design::TwoSample ? 2 : 1) / n); }

double t_power_of(double n, double d, double alpha, Design design, Alternative alternative) {
  const double df = degrees_of_freedom(n, design), ncp = d / error_per_sd(n, design);
  if (alternative == Alternative::Greater)
    return noncentral_t_upper(student_upper_quantile(alpha, df), df, ncp);
  if (alternative == Alternative::Less)
    return noncentral_t_lower(-student_upper_quantile(alpha, df), df, ncp);
  const double critical = student_upper_quantile(alpha / 2, df);
  return noncentral_t_upper(critical, df, ncp) + noncentral_t_lower(-critical, df, ncp);
}

std::string why_no_t_power(double d, double alpha) {
  if (!std::isfinite(d)) return "an effect that is not finite";
  return open_unit(alpha) ? "" : "alpha must lie between 0 and 1";
}

/// ln of the density of chi(df) / sqrt(df).
double log_chi_density(double s, double df) {
  return std::numbers::ln2 + df / 2 * std::log(df / 2) - std::lgamma(df / 2) + (df - 1) * std::log(s) -
         df * s * s / 2;
}

double integral(const std::function<double(double)>& f, double low, double high) {
  use_gsl_codes();
  constexpr std::size_t pieces = 1000;
  const std::unique_ptr<gsl_integration_workspace, decltype(&gsl_integration_workspace_free)> space(
      gsl_integration_workspace_alloc(pieces), &gsl_integration_workspace_free);
  if (!space) throw std::bad_alloc();
  gsl_function wrapped;
  wrapped.function = [](double x, void* user) {
    return (*static_cast<const std::function<double(double)>*>(user))(x);
  };
  wrapped.params = const_cast<std::function<double(double)>*>(&f);
  double value = 0, error = 0;
  gsl_integration_qag(&wrapped, low, high, 1e-13, 1e-11, pieces, GSL_INTEG_GAUSS61, space.get(), &value,
                      &error);
  return value;
}

double tost_power_of(double n, const Equivalence& e) {
  const double df = degrees_of_freedom(n, e.design), error = e.sd * error_per_sd(n, e.design);
  const double low = (e.low - e.difference) / error, high = (e.high - e.difference) / error;
  const double critical = student_upper_quantile(e.alpha, df);
  // The estimate must lie between the margins, each moved inwards by the critical value times the sample's SD
  // (s times the true one). Beyond s = `widest` the moved margins leave no range.
  const double widest = (high - low) / (2 * critical), spread = 12 / std::sqrt(2 * df);
  const double from = std::max(0.0, 1 - spread), to = std::min(widest, 1 + spread);
  if (from >= to) return 0;
  return integral(
      [&](double s) {
        if (s <= 0) return 0.0;
        const double a = low + critical * s, b = high - critical * s;
        // Uses the smaller tail, which has more digits.
        const double inside = a > 0 ? normal_probability(-a) - normal_probability(-b)
                                    : normal_probability(b) - normal_probability(a);
        return std::exp(log_chi_density(s, df)) * inside;
      },
      from, to);
}

std::string why_no_tost(const Equivalence& e) {
  if (!std::isfinite(e.low) || !std::isfinite(e.high) || !std::isfinite(e.difference))
    return "margins and difference must be finite";
  if (!(e.low < e.high)) return "the lower margin must lie below the upper";
  if (!(e.sd > 0) || std::isinf(e.sd)) return "the SD must be positive and finite";
  return e.alpha > 0 && e.alpha <= 0.5 ? "" : "alpha must lie between 0 and 0.5";
}

/// The counts k at which the test is significant: k <= lower or k >= upper. p decreases with the distance
/// from n p0 on either side, so bisection finds `lower` and `upper`.
struct Rejection {
  double lower = -1, upper = 0;
};

Rejection rejection(double n, double p0, double alpha, Alternative alternative) {
  const auto significant = [&](double k) { return binomial_p(k, n, p0, alternative) <= alpha; };
  Rejection out{-1, n + 1};
  if (alternative != Alternative::Less) {
    double low = std::floor(n * p0);  // not significant
    while (out.upper - low > 1) {
      const double middle = std::floor((low + out.upper) / 2);
      (significant(middle) ? out.upper : low) = middle;
    }
  }
  if (alternative != Alternative::Greater) {
    double high = std::ceil(n * p0);
    while (high - out.lower > 1) {
      const double middle = std::floor((high + out.lower) / 2);
      (significant(middle) ? out.lower : high) = middle;
    }
  }
  return out;
}

double rejected(const Rejection& region, double n, double p) {
  return std::exp(log_binomial_lower(region.lower, n, p, 1 - p)) +
         std::exp(log_binomial_upper(region.upper, n, p, 1 - p));
}

std::string why_no_binomial(double p1, double p0, double alpha) {
  if (!(p0 >= 0 && p0 <= 1 && p1 >= 0 && p1 <= 1)) return "proportions must lie in [0, 1]";
  return open_unit(alpha) ? "" : "alpha must lie between 0 and 1";
}

}  // namespace

Result<double> t_power(double n, double d, double alpha, Design design, Alternative alternative) {
  if (!(n > 1) || n > most_participants) return Refusal{"n must be above 1 and at most 1e7"};
  if (const auto reason = why_no_t_power(d, alpha); !reason.empty()) return Refusal{reason};
  return t_power_of(n, d, alpha, design, alternative);
}

Result<double> tost_power(double n, const Equivalence& equivalence) {
  if (!(n > 1) || n > most_participants) return Refusal{"n must be above 1 and at most 1e7"};
  if (const auto reason = why_no_tost(equivalence); !reason.empty()) return Refusal{reason};
  return tost_power_of(n, equivalence);
}

Result<BinomialPower> binomial_power(double n, double p1, double p0, double alpha, Alternative alternative) {
  if (!(n >= 1 && n <= 1e9) || n != std::floor(n)) return Refusal{"n must be a whole number from 1 to 1e9"};
  if (const auto reason = why_no_binomial(p1, p0, alpha); !reason.empty()) return Refusal{reason};
  const Rejection region = rejection(n, p0, alpha, alternative);
  BinomialPower out{.power = rejected(region, n, p1), .actual_alpha = rejected(region, n, p0)};
  if (region.upper <= n) out.k_critical_upper = static_cast<int>(region.upper);
  if (region.lower >= 0) out.k_critical_lower = static_cast<int>(region.lower);
  return out;
}

Result<double> t_detectable(double n, double power, double alpha, Design design, Alternative alternative) {
  const auto without = t_power(n, 0, alpha, design, alternative);
  if (!without) return without;
  if (!(power > alpha && power < 1)) return Refusal{"the power must lie between alpha and 1"};
  const double sign = alternative == Alternative::Less ? -1 : 1;
  const auto lacking = [&](double d) { return t_power_of(n, sign * d, alpha, design, alternative) - power; };
  double high = 1;
  while (lacking(high) < 0) high *= 2;
  return find_root(lacking, 0, high);
}

Result<double> binomial_detectable(int n, double power, double alpha) {
  if (!open_unit(power)) return Refusal{"the power must lie between 0 and 1"};
  const auto at_one = binomial_power(n, 1, 0.5, alpha);
  if (!at_one) return Refusal{at_one.reason()};
  if (at_one->power < power)
    return Refusal{"too few answers: not even a choice by all is significant at this level"};
  const auto lacking = [&](double p) { return binomial_power(n, p, 0.5, alpha)->power - power; };
  // The power is smallest at 0.5 (alpha or less) and increases from there.
  if (lacking(0.5) >= 0) return 0.5;
  return find_root(lacking, 0.5, 1);
}

}  // namespace stats
