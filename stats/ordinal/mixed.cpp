#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"
#include "stats/ordinal/cumulative_link.hpp"
#include "stats/ordinal/mixed_likelihood.hpp"
#include "stats/ordinal/rows.hpp"

namespace stats {

namespace {

/// Beyond, the participants' own thresholds are apart by more than a rating can tell.
constexpr double largest_sd = 30;

std::string too_few(const OrdinalRows& rows) {
  if (rows.participants < 2) return "one participant has no spread of participants";
  std::vector<int> ratings(static_cast<std::size_t>(rows.participants));
  for (const int p : rows.participant) ++ratings[static_cast<std::size_t>(p)];
  if (*std::max_element(ratings.begin(), ratings.end()) < 2)
    return "one rating from each participant: their spread cannot be told from the ratings' own";
  return "";
}

/// Minus the log-likelihood of thresholds, beta and sd.
Objective deviance(MixedLikelihood& likelihood, const OrdinalRows& rows) {
  return [&likelihood, &rows](std::span<const double> at, std::span<double> gradient) {
    const auto q = static_cast<std::size_t>(rows.thresholds()), k = rows.x.size();
    MixedGradient slopes;
    const double value = likelihood.evaluate(at.first(q), rows.location(at.subspan(q, k)), at[q + k], slopes);
    for (std::size_t j = 0; j < q; ++j) gradient[j] = -slopes.thresholds[j];
    for (std::size_t c = 0; c < k; ++c) {
      gradient[q + c] = 0;
      for (std::size_t i = 0; i < rows.n(); ++i) gradient[q + c] -= slopes.location[i] * rows.x[c][i];
    }
    gradient[q + k] = -slopes.sd;
    return -value;
  };
}

/// Thresholds and beta in standardised units, of a fit in the predictors' own.
std::vector<double> standardised(const OrdinalFit& fit, const OrdinalRows& rows) {
  std::vector<double> at = fit.thresholds;
  for (std::size_t k = 0; k < fit.beta.size(); ++k) {
    for (std::size_t j = 0; j < fit.thresholds.size(); ++j) at[j] -= fit.beta[k] * rows.centre[k];
    at.push_back(fit.beta[k] * rows.scale[k]);
  }
  return at;
}

}  // namespace

Result<MixedOrdinalFit> fit_cumulative_link_mixed(std::span<const double> ratings,
                                                  std::span<const Predictor> predictors,
                                                  std::span<const int> participants, Link link, int points) {
  if (points < 1 || points > 101) throw std::invalid_argument("1 to 101 nodes of quadrature");
  if (participants.size() != ratings.size())
    throw std::invalid_argument("ratings and participants differ in length");
  const auto rows = ordinal_rows(ratings, predictors, participants);
  if (!rows) return Refusal{rows.reason()};
  if (const auto reason = too_few(*rows); !reason.empty()) return Refusal{reason};
  // Where the ratings are separated without participants, they are so with them.
  const auto fixed = fit_cumulative_link(ratings, predictors, link);
  if (!fixed) return Refusal{fixed.reason()};
  MixedLikelihood likelihood(rows->category, rows->participant, link, points);
  auto start = standardised(*fixed, *rows);
  start.push_back(link == Link::Logit ? 0.8 : 0.5);
  const auto best = minimise(deviance(likelihood, *rows), start);
  const std::size_t p = start.size() - 1;
  if (std::abs(best.x[p]) > largest_sd)
    return Refusal{"the spread of the participants has no bound: each one's ratings agree with themselves"};
  if (!best.converged) return Refusal{"the mixed fit did not converge"};
  const auto all = Cholesky::of(best.hessian)->inverse();
  std::vector<double> covariance;
  for (std::size_t i = 0; i < p; ++i) {
    for (std::size_t j = 0; j < p; ++j) covariance.push_back(all[i * (p + 1) + j]);
  }
  MixedOrdinalFit fit;
  fit.link = link;
  fit.log_likelihood = -best.value;
  fit.sd_participant = std::abs(best.x[p]);
  fit.participants = rows->participants;
  fit.points = points;
  set_original_units(fit, *rows, std::span(best.x).first(p), covariance);
  return fit;
}

}  // namespace stats
