#include "stats/ordinal/cumulative_link.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "stats/cholesky.hpp"
#include "stats/gsl_errors.hpp"
#include "stats/ordinal/rows.hpp"

namespace stats {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Log-likelihood, gradient and observed information at thresholds and beta.
struct Information {
  double log_likelihood = 0;
  std::vector<double> gradient, negative_hessian;
};

Information information(const OrdinalRows& rows, Link link, std::span<const double> parameters) {
  const auto q = static_cast<std::size_t>(rows.thresholds()), k = rows.x.size(), p = q + k;
  Information out{0, std::vector<double>(p), std::vector<double>(p * p)};
  const auto location = rows.location(parameters.subspan(q));
  std::vector<double> row(p), by_location(p);
  for (std::size_t i = 0; i < rows.n(); ++i) {
    const auto c = static_cast<std::size_t>(rows.category[i]);
    const auto t =
        category_term(link, c ? parameters[c - 1] : -infinity, c < q ? parameters[c] : infinity, location[i]);
    out.log_likelihood += t.log_p;
    auto& h = out.negative_hessian;
    if (c < q) {
      out.gradient[c] += t.up;
      h[c * p + c] -= t.up_up;
    }
    if (c) {
      out.gradient[c - 1] += t.lo;
      h[(c - 1) * p + c - 1] -= t.lo_lo;
    }
    if (c && c < q) h[c * p + c - 1] -= t.up_lo;
    for (std::size_t a = 0; a < k; ++a) {
      const double x = rows.x[a][i];
      out.gradient[q + a] += t.d1 * x;
      if (c < q) h[(q + a) * p + c] -= t.up1 * x;
      if (c) h[(q + a) * p + c - 1] -= t.lo1 * x;
      for (std::size_t b = 0; b <= a; ++b) h[(q + a) * p + q + b] -= t.d2 * x * rows.x[b][i];
    }
  }
  return out;
}

bool ascending(std::span<const double> thresholds) {
  return std::adjacent_find(thresholds.begin(), thresholds.end(), std::greater_equal<>()) == thresholds.end();
}

/// Names the predictors along which the likelihood increases without bound.
std::string separation(std::span<const Predictor> predictors, std::span<const double> step) {
  const std::size_t q = step.size() - predictors.size();
  double largest = 0;
  for (std::size_t k = q; k < step.size(); ++k) largest = std::max(largest, std::abs(step[k]));
  std::string names;
  for (std::size_t k = q; k < step.size(); ++k) {
    if (std::abs(step[k]) > 0.1 * largest) names += (names.empty() ? "" : ", ") + predictors[k - q].name;
  }
  return "separation: the ratings are split without overlap by " + names +
         ", so that the likelihood has no maximum";
}

/// Newton's method with step halving. At a maximum the steps vanish; without one (separation) they keep their
/// length until the information is singular.
struct Climb {
  std::vector<double> at, covariance, last_step;
  double log_likelihood = 0;
  bool converged = false;
};

Climb climb(const OrdinalRows& rows, Link link) {
  Climb out;
  out.at = marginal_thresholds(rows.category, rows.thresholds() + 1, link);
  const std::size_t q = out.at.size();
  out.at.resize(q + rows.x.size());
  out.last_step.assign(out.at.size(), 0);
  auto here = information(rows, link, out.at);
  for (int iteration = 0; iteration < 60; ++iteration) {
    out.log_likelihood = here.log_likelihood;
    const auto factor = Cholesky::of(here.negative_hessian, 1e-15);
    if (!factor) return out;
    out.last_step = factor->solve(here.gradient);
    double largest = 0;
    for (const double s : out.last_step) largest = std::max(largest, std::abs(s));
    if (largest < 1e-9) {
      out.covariance = factor->inverse();
      out.converged = true;
      return out;
    }
    bool moved = false;
    auto next = out.at;
    for (double length = 1; length > 1e-9 && !moved; length /= 2) {
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = out.at[i] + length * out.last_step[i];
      if (!ascending({next.data(), q})) continue;
      auto there = information(rows, link, next);
      const double slack = 1e-13 * std::abs(here.log_likelihood);
      if (!(there.log_likelihood >= here.log_likelihood - slack)) continue;
      moved = true;
      here = std::move(there);
    }
    if (!moved) return out;
    out.at = next;
  }
  return out;
}

}  // namespace

std::vector<double> OrdinalFit::se() const {
  const std::size_t p = thresholds.size() + beta.size();
  std::vector<double> out;
  for (std::size_t i = 0; i < p; ++i) out.push_back(std::sqrt(covariance[i * p + i]));
  return out;
}

Result<OrdinalFit> fit_cumulative_link(std::span<const double> ratings, std::span<const Predictor> predictors,
                                       Link link) {
  const auto rows = ordinal_rows(ratings, predictors, {});
  if (!rows) return Refusal{rows.reason()};
  const auto top = climb(*rows, link);
  if (!top.converged) return Refusal{separation(predictors, top.last_step)};
  OrdinalFit fit;
  fit.link = link;
  fit.log_likelihood = top.log_likelihood;
  set_original_units(fit, *rows, top.at, top.covariance);
  return fit;
}

LikelihoodRatio likelihood_ratio(double log_likelihood_full, double log_likelihood_reduced, int df) {
  use_gsl_codes();
  if (df < 1) throw std::invalid_argument("a likelihood ratio needs at least one degree of freedom");
  const double chi2 = std::max(0.0, 2 * (log_likelihood_full - log_likelihood_reduced));
  return {chi2, df, gsl_cdf_chisq_Q(chi2, df)};
}

}  // namespace stats
