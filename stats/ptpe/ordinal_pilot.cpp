#include "stats/ptpe/ordinal_pilot.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"
#include "stats/ordinal/level_thresholds.hpp"
#include "stats/ordinal/mixed_likelihood.hpp"
#include "stats/ptpe/direct_fit.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

/// Ratings as categories, at x = log mu and d = delta / delta_unit, each minus its mean, for a frame rate of
/// mean mu and standard deviation delta.
struct Rows {
  std::vector<double> x, d;
  std::vector<int> category, participant;
  std::vector<double> levels;
  double x_mean = 0, delta_mean = 0;

  std::size_t n() const { return x.size(); }
  std::size_t thresholds() const { return levels.size() - 1; }
};

double realised(const PilotRating& r, PilotMean mean) {
  return mean == PilotMean::Harmonic ? r.realised_mu : r.realised_mu_arithmetic;
}

/// Converts ratings to rows. x and d are centred at the means of these ratings, or at the means of `others`.
Rows rows_of(std::span<const PilotRating> ratings, PilotMean mean, const Rows* others = nullptr) {
  Rows rows;
  std::set<double> scores;
  std::map<int, int> people;
  const double n = static_cast<double>(ratings.size());
  for (const auto& r : ratings) {
    scores.insert(r.score);
    rows.x_mean += std::log(realised(r, mean)) / n;
    rows.delta_mean += r.realised_delta / n;
  }
  if (others) {
    rows.x_mean = others->x_mean;
    rows.delta_mean = others->delta_mean;
  }
  rows.levels.assign(scores.begin(), scores.end());
  for (const auto& r : ratings) {
    rows.x.push_back(std::log(realised(r, mean)) - rows.x_mean);
    rows.d.push_back((r.realised_delta - rows.delta_mean) / delta_unit);
    rows.category.push_back(static_cast<int>(std::distance(scores.begin(), scores.find(r.score))));
    rows.participant.push_back(people.emplace(r.participant, static_cast<int>(people.size())).first->second);
  }
  return rows;
}

/// Order of the parameters that follow the log gaps of the thresholds.
enum : std::size_t { Alpha, Beta, K, M, Q, Sd, Count };

Objective deviance(MixedLikelihood& likelihood, const Rows& rows, double level) {
  return [&likelihood, &rows, level](std::span<const double> at, std::span<double> gradient) {
    const std::size_t gaps = rows.thresholds() - 1;
    const auto p = at.subspan(gaps);
    if (std::abs(p[Sd]) > 50) return std::numeric_limits<double>::infinity();
    for (const double gap : at.first(gaps)) {
      if (std::abs(gap) > 20) return std::numeric_limits<double>::infinity();
    }
    const auto scale = level_thresholds(at.first(gaps), p[Sd], rows.levels, level);
    std::vector<double> location(rows.n());
    for (std::size_t i = 0; i < rows.n(); ++i) {
      const double u = rows.x[i] - p[Alpha] - p[Beta] * rows.d[i];
      location[i] = u * (p[K] + p[M] * rows.d[i] + p[Q] * u);
    }
    MixedGradient slopes;
    const double value = likelihood.evaluate(scale.theta, location, p[Sd], slopes);
    std::fill(gradient.begin(), gradient.end(), 0.0);
    const double shift = scale.by_gaps(at.first(gaps), slopes.thresholds, gradient.first(gaps));
    for (double& g : gradient.first(gaps)) g = -g;
    const auto out = gradient.subspan(gaps);
    out[Sd] = -slopes.sd - shift * scale.by_sd;
    for (std::size_t i = 0; i < rows.n(); ++i) {
      const double d = rows.d[i], u = rows.x[i] - p[Alpha] - p[Beta] * d;
      const double by_u = p[K] + p[M] * d + 2 * p[Q] * u, g = slopes.location[i];
      out[Alpha] += g * by_u;
      out[Beta] += g * by_u * d;
      out[K] -= g * u;
      out[M] -= g * u * d;
      out[Q] -= g * u * u;
    }
    return -value;
  };
}

/// The optimiser's parameters of a fit, in the rows' centred variables. fit_of() converts them back.
std::vector<double> parameters_of(const OrdinalPilotFit& fit, const Rows& rows) {
  std::vector<double> out;
  for (std::size_t j = 0; j + 1 < fit.thresholds.size(); ++j)
    out.push_back(std::log(fit.thresholds[j + 1] - fit.thresholds[j]));
  out.insert(out.end(), {fit.curve.log_a + fit.curve.b * rows.delta_mean - rows.x_mean,
                         fit.curve.b * delta_unit, fit.k + fit.m * rows.delta_mean, fit.m * delta_unit, fit.q,
                         std::max(fit.sd_participant, 0.05)});
  return out;
}

OrdinalPilotFit fit_of(const Minimum& best, const Rows& rows, double level) {
  const std::size_t gaps = rows.thresholds() - 1;
  const auto p = std::span(best.x).subspan(gaps);
  OrdinalPilotFit fit;
  fit.level = level;
  fit.levels = rows.levels;
  fit.thresholds = level_thresholds(std::span(best.x).first(gaps), p[Sd], rows.levels, level).theta;
  fit.curve.b = p[Beta] / delta_unit;
  fit.curve.log_a = p[Alpha] + rows.x_mean - fit.curve.b * rows.delta_mean;
  fit.m = p[M] / delta_unit;
  fit.k = p[K] - fit.m * rows.delta_mean;
  fit.q = p[Q];
  fit.sd_participant = std::abs(p[Sd]);
  fit.log_likelihood = -best.value;
  fit.n = static_cast<int>(rows.n());
  return fit;
}

/// Initial values from the direct fit: its residual deviation is the unit of the latent scale, and thresholds
/// lie half way between scores.
Result<OrdinalPilotFit> first_guess(std::span<const PilotRating> ratings, PilotMean mean, double level,
                                    const Rows& rows) {
  const auto observations = PilotTable(ratings).observations(mean);
  const auto direct = DirectModel(observations, level).fit();
  if (!direct) return Refusal{direct.reason()};
  const double unit = std::max(0.2, std::sqrt(direct->rss / direct->n));
  OrdinalPilotFit guess;
  guess.curve = direct->curve;
  guess.k = direct->k / unit;
  guess.m = direct->m / unit;
  guess.q = direct->q / unit;
  guess.sd_participant = 0.4;
  for (std::size_t j = 0; j + 1 < rows.levels.size(); ++j)
    guess.thresholds.push_back(((rows.levels[j] + rows.levels[j + 1]) / 2 - level) / unit);
  return guess;
}

bool rises(const OrdinalPilotFit& fit, const Rows& rows) {
  const auto [low, high] = std::minmax_element(rows.x.begin(), rows.x.end());
  for (std::size_t i = 0; i < rows.n(); ++i) {
    const double delta = rows.d[i] * delta_unit + rows.delta_mean;
    const double x = fit.curve.log_a + fit.curve.b * delta - rows.x_mean;
    if (x >= *low && x <= *high && !(fit.k + fit.m * delta > 0)) return false;
  }
  return true;
}

/// A fit, with the values from which the fits without one participant start.
struct FittedPilot {
  OrdinalPilotFit fit;
  Rows rows;
  std::vector<double> at, inverse_hessian;
};

Result<OrdinalPilotFit> checked(const Minimum& best, const Rows& rows, double level) {
  if (!best.converged) return Refusal{"the ordinal fit did not converge"};
  const auto fit = fit_of(best, rows, level);
  if (!rises(fit, rows)) return Refusal{"the scores do not rise with the frame rate all along the curve"};
  return fit;
}

Result<FittedPilot> fit_all(std::span<const PilotRating> ratings, PilotMean mean, double level, int points) {
  if (ratings.empty()) return Refusal{"no ratings"};
  auto rows = rows_of(ratings, mean);
  if (rows.levels.size() < 2) return Refusal{"all ratings are equal: there is no threshold to estimate"};
  if (!(level > rows.levels.front() && level < rows.levels.back()))
    return Refusal{"the level does not lie between the lowest and the highest rating given"};
  const auto guess = first_guess(ratings, mean, level, rows);
  if (!guess) return Refusal{guess.reason()};
  MixedLikelihood likelihood(rows.category, rows.participant, Link::Probit, points);
  const auto objective = deviance(likelihood, rows, level);
  const auto start = parameters_of(*guess, rows);
  std::vector<double> slope(start.size());
  if (!std::isfinite(objective(start, slope)))
    return Refusal{"the ordinal fit has no start: a rating is too far from what its setting makes likely"};
  const auto best = minimise(objective, start);
  const auto fit = checked(best, rows, level);
  if (!fit) return Refusal{fit.reason()};
  return FittedPilot{*fit, std::move(rows), best.x, Cholesky::of(best.hessian)->inverse()};
}

/// A fit to a part of the same ratings: started from `whole`, or from first_guess() if a score no longer
/// occurs in the part.
Result<OrdinalPilotFit> fit_part(std::span<const PilotRating> ratings, PilotMean mean, double level,
                                 const FittedPilot& whole) {
  const auto rows = rows_of(ratings, mean, &whole.rows);
  if (rows.levels != whole.rows.levels) return fit_ordinal_pilot(ratings, mean, level);
  MixedLikelihood likelihood(rows.category, rows.participant, Link::Probit, 1);
  return checked(minimise_near(deviance(likelihood, rows, level), whole.at, whole.inverse_hessian), rows,
                 level);
}

/// Fits without each participant in turn, in parallel; returns the first refusal if there is one.
Result<std::vector<Curve>> leave_one_out(const std::vector<PilotRating>& ratings,
                                         const std::vector<int>& people, PilotMean mean, double level,
                                         const FittedPilot& whole) {
  std::vector<Result<OrdinalPilotFit>> fits(people.size(), Refusal{"not computed"});
#pragma omp parallel for schedule(dynamic)
  for (std::size_t p = 0; p < people.size(); ++p) {
    std::vector<PilotRating> others;
    std::copy_if(ratings.begin(), ratings.end(), std::back_inserter(others),
                 [&](const auto& r) { return r.participant != people[p]; });
    fits[p] = fit_part(others, mean, level, whole);
  }
  std::vector<Curve> curves;
  for (const auto& fit : fits) {
    if (!fit) return Refusal{"one participant decides whether there is a fit: without them " + fit.reason()};
    curves.push_back(fit->curve);
  }
  return curves;
}

}  // namespace

Result<OrdinalPilotFit> fit_ordinal_pilot(std::span<const PilotRating> ratings, PilotMean mean, double level,
                                          int points) {
  const auto fitted = fit_all(ratings, mean, level, points);
  return fitted ? Result<OrdinalPilotFit>(fitted->fit) : Refusal{fitted.reason()};
}

OrdinalPilotEstimate estimate_ordinal_pilot(std::span<const PilotRating> ratings, PilotMean mean,
                                            double level, double confidence) {
  OrdinalPilotEstimate out;
  const auto refuse = [&](const std::string& reason) {
    out.jackknife = Refusal{reason};
    return out;
  };
  if (!ratings.empty())
    out.out_of_reach = within_reach(PilotTable(ratings).observations(mean), level).left_out;
  std::vector<PilotRating> kept;
  std::set<int> everyone;
  for (const auto& r : ratings) {
    if (std::binary_search(out.out_of_reach.begin(), out.out_of_reach.end(), r.delta)) continue;
    kept.push_back(r);
    everyone.insert(r.participant);
  }
  const auto whole = fit_all(kept, mean, level, 1);
  if (!whole) {
    out.fit = Refusal{whole.reason()};
    return refuse(whole.reason());
  }
  out.fit = whole->fit;
  const std::vector<int> people(everyone.begin(), everyone.end());
  if (const int n = static_cast<int>(people.size()); n < least_participants) {
    return refuse("an interval over participants needs at least " + std::to_string(least_participants) +
                  " of them, not " + std::to_string(n));
  }
  const auto without = leave_one_out(kept, people, mean, level, *whole);
  if (!without) return refuse(without.reason());
  out.jackknife = jackknife_curve(out.fit->curve, *without, confidence);
  return out;
}

}  // namespace stats
