#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"
#include "stats/ordinal/cumulative_link.hpp"
#include "stats/ordinal/mixed_likelihood.hpp"
#include "stats/ordinal/rows.hpp"

namespace stats {

namespace {

/// Largest sd of the participants' effects; beyond it their thresholds differ by more than ratings can
/// resolve.
constexpr double largest_sd = 30;

std::string too_few(const OrdinalRows& rows) {
  if (rows.participants < 2) return "one participant has no spread of participants";
  std::vector<int> ratings(static_cast<std::size_t>(rows.participants));
  for (const int p : rows.participant) ++ratings[static_cast<std::size_t>(p)];
  if (*std::max_element(ratings.begin(), ratings.end()) < 2)
    return "one rating from each participant: their spread cannot be separated from that of the ratings";
  return "";
}

/// Log density of log-F(1, 1) at beta, minus that at 0.
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

/// Minus the log-likelihood as a function of thresholds, beta and sd; or minus the penalised one.
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

/// Thresholds and beta in standardised units, from a fit in the predictors' own units.
std::vector<double> standardised(const OrdinalFit& fit, const OrdinalRows& rows) {
  std::vector<double> at = fit.thresholds;
  for (std::size_t k = 0; k < fit.beta.size(); ++k) {
    for (std::size_t j = 0; j < fit.thresholds.size(); ++j) at[j] -= fit.beta[k] * rows.centre[k];
    at.push_back(fit.beta[k] * rows.scale[k]);
  }
  return at;
}

/// Start of the search: the fit without participants, or if there is none, zero effects.
std::vector<double> start_of(const Result<OrdinalFit>& fixed, const OrdinalRows& rows, Link link) {
  auto start =
      fixed ? standardised(*fixed, rows) : marginal_thresholds(rows.category, rows.thresholds() + 1, link);
  start.resize(static_cast<std::size_t>(rows.thresholds()) + rows.x.size());
  start.push_back(link == Link::Logit ? 0.8 : 0.5);
  return start;
}

/// Rows and columns of thresholds and beta, from the inverse of a Hessian that also includes sd.
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
  if (points < 1 || points > 101) throw std::invalid_argument("1 to 101 nodes of quadrature");
  if (separation == Separation::Penalise && link != Link::Logit)
    throw std::invalid_argument("the penalty is one of log odds");
  if (participants.size() != ratings.size())
    throw std::invalid_argument("ratings and participants differ in length");
  const auto rows = ordinal_rows(ratings, predictors, participants);
  if (!rows) return Refusal{rows.reason()};
  if (const auto reason = too_few(*rows); !reason.empty()) return Refusal{reason};
  // Ratings that are separated without participants are also separated with them.
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
