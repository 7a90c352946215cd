#include "stats/ordinal/cumulative_link.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "stats/cholesky.hpp"
#include "stats/gsl_errors.hpp"
#include "stats/minimise.hpp"
#include "stats/ordinal/mixed_likelihood.hpp"
#include "stats/ordinal/rows.hpp"
#include "stats/quantiles.hpp"

namespace stats {

const char* link_name(Link link) { return link == Link::Logit ? "logit" : "probit"; }

LinkValue link_value(Link link, double x) {
  if (std::isinf(x)) return {x > 0 ? 1.0 : 0.0, 0, 0, 0};
  if (link == Link::Logit) {
    const double e = std::exp(-std::abs(x)), small = e / (1 + e), large = 1 / (1 + e);
    const double F = x < 0 ? small : large, f = small * large;
    return {F, f, f * (x < 0 ? large - small : small - large), f * (1 - 6 * f)};
  }
  const double f = std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
  return {std::erfc(-x / std::numbers::sqrt2) / 2, f, -x * f, (x * x - 1) * f};
}

double link_quantile(Link link, double p) {
  if (link == Link::Probit) return normal_quantile(p);
  if (!(p > 0 && p < 1))
    throw std::invalid_argument("link_quantile: p is not between 0 and 1; give a probability in (0, 1)");
  return std::log(p) - std::log1p(-p);
}

CategoryTerm category_term(Link link, double lower, double upper, double location) {
  const auto a = link_value(link, upper - location), c = link_value(link, lower - location);
  // If both thresholds lie above the location, the difference of the upper tails is more accurate: F(x) = 1 -
  // F(-x).
  const double p = lower > location
                       ? link_value(link, location - lower).F - link_value(link, location - upper).F
                       : a.F - c.F;
  CategoryTerm t;
  if (!(p > std::numeric_limits<double>::min())) {
    t.log_p = -std::numeric_limits<double>::infinity();
    return t;
  }
  t.log_p = std::log(p);
  // Derivatives of P with respect to the location, divided by P (n1, n2, n3), then those of log P (d1, d2,
  // d3).
  const double n1 = (c.f - a.f) / p, n2 = (a.f1 - c.f1) / p, n3 = (c.f2 - a.f2) / p;
  t.d1 = n1;
  t.d2 = n2 - n1 * n1;
  t.d3 = n3 - 3 * n2 * n1 + 2 * n1 * n1 * n1;
  const auto threshold = [&](double f, double f1, double f2, double& d, double& dv, double& dvv) {
    d = f;
    dv = -f1 - f * n1;
    dvv = f2 + 2 * f1 * n1 - f * n2 + 2 * f * n1 * n1;
  };
  threshold(a.f / p, a.f1 / p, a.f2 / p, t.up, t.up1, t.up2);
  threshold(-c.f / p, -c.f1 / p, -c.f2 / p, t.lo, t.lo1, t.lo2);
  t.up_up = a.f1 / p - t.up * t.up;
  t.lo_lo = -c.f1 / p - t.lo * t.lo;
  t.up_lo = -t.up * t.lo;
  return t;
}

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

/// Newton's method with step halving. Near a maximum the steps vanish. Without a maximum (separation) the
/// steps keep their length until the information matrix is singular.
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
  if (df < 1)
    throw std::invalid_argument(
        "likelihood_ratio: df is below 1; give the number of parameters by which the fits differ");
  const double chi2 = std::max(0.0, 2 * (log_likelihood_full - log_likelihood_reduced));
  return {chi2, df, gsl_cdf_chisq_Q(chi2, df)};
}

namespace {

/// Largest sd of the participants' effects; beyond it their thresholds differ by more than ratings can
/// resolve.
constexpr double largest_sd = 30;

std::string why_too_few(const OrdinalRows& rows) {
  if (rows.participants < 2) return "fewer than two participants: their spread cannot be estimated";
  std::vector<int> ratings(static_cast<std::size_t>(rows.participants));
  for (const int p : rows.participant) ++ratings[static_cast<std::size_t>(p)];
  if (*std::max_element(ratings.begin(), ratings.end()) < 2)
    return "one rating from each participant: their spread cannot be separated from that of the ratings";
  return "";
}

/// Log density of the log-F(1, 1) distribution at beta, minus its log density at 0.
double log_prior(double beta) {
  const double half = std::abs(beta) / 2;
  return -(half + std::log1p(std::exp(-2 * half)) - std::numbers::ln2);  // -log cosh, without overflow
}

double log_prior_slope(double beta) { return -std::tanh(beta / 2) / 2; }

double log_prior(std::span<const double> standardised_beta, const OrdinalRows& rows) {
  double sum = 0;
  for (std::size_t c = 0; c < standardised_beta.size(); ++c)
    sum += log_prior(standardised_beta[c] / rows.scale[c]);
  return sum;
}

/// Minus the log-likelihood as a function of thresholds, beta and sd; if `penalised`, minus the penalised
/// log-likelihood.
Objective deviance(MixedLikelihood& likelihood, const OrdinalRows& rows, bool penalised) {
  return [&likelihood, &rows, penalised](std::span<const double> at, std::span<double> gradient) {
    const auto q = static_cast<std::size_t>(rows.thresholds()), k = rows.x.size();
    MixedGradient slopes;
    double value = likelihood.evaluate(at.first(q), rows.location(at.subspan(q, k)), at[q + k], slopes);
    for (std::size_t j = 0; j < q; ++j) gradient[j] = -slopes.thresholds[j];
    for (std::size_t c = 0; c < k; ++c) {
      gradient[q + c] = penalised ? -log_prior_slope(at[q + c] / rows.scale[c]) / rows.scale[c] : 0;
      for (std::size_t i = 0; i < rows.n(); ++i) gradient[q + c] -= slopes.location[i] * rows.x[c][i];
    }
    gradient[q + k] = -slopes.sd;
    if (penalised) value += log_prior(at.subspan(q, k), rows);
    return -value;
  };
}

/// Thresholds and beta in standardised units, from a fit in the predictors' original units.
std::vector<double> standardised(const OrdinalFit& fit, const OrdinalRows& rows) {
  std::vector<double> at = fit.thresholds;
  for (std::size_t k = 0; k < fit.beta.size(); ++k) {
    for (std::size_t j = 0; j < fit.thresholds.size(); ++j) at[j] -= fit.beta[k] * rows.centre[k];
    at.push_back(fit.beta[k] * rows.scale[k]);
  }
  return at;
}

/// Start of the search: thresholds and beta of the fit without participants' effects, or marginal thresholds
/// and beta = 0 if that fit was refused; then a fixed sd.
std::vector<double> start_of(const Result<OrdinalFit>& fixed, const OrdinalRows& rows, Link link) {
  auto start =
      fixed ? standardised(*fixed, rows) : marginal_thresholds(rows.category, rows.thresholds() + 1, link);
  start.resize(static_cast<std::size_t>(rows.thresholds()) + rows.x.size());
  start.push_back(link == Link::Logit ? 0.8 : 0.5);
  return start;
}

/// Covariance of thresholds and beta: their rows and columns of the inverse of a Hessian that also includes
/// sd.
std::vector<double> covariance_of(std::span<const double> hessian, std::size_t p) {
  const auto all = Cholesky::of(hessian)->inverse();
  std::vector<double> out;
  for (std::size_t i = 0; i < p; ++i) {
    for (std::size_t j = 0; j < p; ++j) out.push_back(all[i * (p + 1) + j]);
  }
  return out;
}

}  // namespace

Result<MixedOrdinalFit> fit_cumulative_link_mixed(std::span<const double> ratings,
                                                  std::span<const Predictor> predictors,
                                                  std::span<const int> participants, Link link, int points,
                                                  Separation separation) {
  if (points < 1 || points > 101)
    throw std::invalid_argument(
        "fit_cumulative_link_mixed: `points` must be 1 to 101 nodes of quadrature, not " +
        std::to_string(points));
  if (separation == Separation::Penalise && link != Link::Logit)
    throw std::invalid_argument(
        "fit_cumulative_link_mixed: Separation::Penalise needs log odds; use it with Link::Logit alone");
  if (participants.size() != ratings.size())
    throw std::invalid_argument(
        "fit_cumulative_link_mixed: ratings and participants differ in length; give one participant for each "
        "rating");
  const auto rows = ordinal_rows(ratings, predictors, participants);
  if (!rows) return Refusal{rows.reason()};
  if (const auto reason = why_too_few(*rows); !reason.empty()) return Refusal{reason};
  // Ratings that are separated in the model without participants' effects are also separated in the model
  // with them.
  const auto fixed = fit_cumulative_link(ratings, predictors, link);
  const bool penalised = !fixed && separation == Separation::Penalise;
  if (!fixed && !penalised) return Refusal{fixed.reason()};
  MixedLikelihood likelihood(rows->category, rows->participant, link, points);
  const auto best = minimise(deviance(likelihood, *rows, penalised), start_of(fixed, *rows, link));
  const std::size_t p = best.x.size() - 1, q = static_cast<std::size_t>(rows->thresholds());
  if (std::abs(best.x[p]) > largest_sd)
    return Refusal{"the spread of the participants has no bound: each one's ratings agree with themselves"};
  if (!best.converged) return Refusal{"the mixed fit did not converge"};
  MixedOrdinalFit fit;
  fit.link = link;
  if (penalised) {
    fit.why_penalised = fixed.reason();
    fit.log_prior = log_prior(std::span(best.x).subspan(q, p - q), *rows);
  }
  fit.log_likelihood = -best.value - fit.log_prior;
  fit.sd_participant = std::abs(best.x[p]);
  fit.participants = rows->participants;
  fit.points = points;
  set_original_units(fit, *rows, std::span(best.x).first(p), covariance_of(best.hessian, p));
  return fit;
}

}  // namespace stats
