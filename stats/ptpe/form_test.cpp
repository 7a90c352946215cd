#include "stats/ptpe/form_test.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "stats/gsl_errors.hpp"
#include "stats/inference/power.hpp"
#include "stats/ptpe/term_sums.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

constexpr std::size_t terms = 9;  // 1, x, e, x e, x^2, e^2, x e^2, e^3, e^4
using Sums = TermSums<terms>;

/// Parameters of the surface: u = x - alpha - beta e - gamma e^2, with x = log mu minus its mean and e =
/// (delta - middle) / half, for a frame rate of mean mu and standard deviation delta. The score minus the
/// level is u (k + m e + q u).
struct Place {
  static constexpr std::size_t terms = stats::terms, parameters = 6;
  double alpha = 0, beta = 0, gamma = 0, k = 0, m = 0, q = 0;

  std::array<double, terms> coefficients() const {
    return {-k * alpha + q * alpha * alpha,
            k - 2 * q * alpha,
            -k * beta - m * alpha + 2 * q * alpha * beta,
            m - 2 * q * beta,
            q,
            -k * gamma - m * beta + q * (beta * beta + 2 * alpha * gamma),
            -2 * q * gamma,
            -m * gamma + 2 * q * beta * gamma,
            q * gamma * gamma};
  }
  /// Derivatives of coefficients(): one row each for alpha, beta, gamma, k, m and q.
  std::array<std::array<double, terms>, 6> jacobian() const {
    const double slope = -k + 2 * q * alpha, turn = -m + 2 * q * beta, bend = 2 * q * gamma;
    return {{{slope, -2 * q, turn, 0, 0, bend, 0, 0, 0},
             {0, 0, slope, -2 * q, 0, turn, 0, bend, 0},
             {0, 0, 0, 0, 0, slope, -2 * q, turn, bend},
             {-alpha, 1, -beta, 0, 0, -gamma, 0, 0, 0},
             {0, 0, -alpha, 1, 0, -beta, 0, -gamma, 0},
             {alpha * alpha, -2 * alpha, 2 * alpha * beta, -2 * beta, 1, beta * beta + 2 * alpha * gamma,
              -2 * gamma, 2 * beta * gamma, gamma * gamma}}};
  }
  Place moved(const std::array<double, 6>& step) const {
    return {alpha + step[0], beta + step[1], gamma + step[2], k + step[3], m + step[4], q + step[5]};
  }
  bool rises() const { return k - std::abs(m) > 0; }  // on the curve, at all e in [-1, 1]
};

/// The sums of the terms over the ratings of each participant and of all, with the constants of the variables
/// x = log mu - centre and e = (delta - middle) / half.
struct Ratings {
  std::vector<Sums> people;
  Sums all;
  double middle = 0, half = 1, centre = 0;  ///< middle and half range of delta; mean of log mu
};

/// The settings not far below the curve (far_below_factor), at standard deviations at which the curve lies no
/// higher than the highest frame rate shown.
std::vector<PilotObservation> near_curve(std::span<const PilotObservation> observations, const Curve& curve) {
  std::map<double, double> highest;  // highest mean frame rate shown, by nominal delta
  for (const auto& o : observations) {
    double& here = highest[o.nominal_delta];
    here = std::max(here, o.mu);
  }
  std::vector<PilotObservation> out;
  for (const auto& o : observations) {
    const double threshold = curve.mu(o.nominal_delta);
    if (threshold <= highest[o.nominal_delta] && o.nominal_mu * far_below_factor >= threshold)
      out.push_back(o);
  }
  return out;
}

std::optional<Ratings> collect(const std::vector<PilotObservation>& observations, double level) {
  std::set<double> deltas;
  int participants = 0;
  Ratings out;
  for (const auto& o : observations) {
    deltas.insert(o.nominal_delta);
    participants = std::max(participants, o.participant + 1);
    out.centre += std::log(o.mu) / static_cast<double>(observations.size());
  }
  if (deltas.size() < 3) return std::nullopt;
  out.middle = (*deltas.begin() + *deltas.rbegin()) / 2;
  out.half = (*deltas.rbegin() - *deltas.begin()) / 2;
  out.people.resize(static_cast<std::size_t>(participants));
  for (const auto& o : observations) {
    const double x = std::log(o.mu) - out.centre, e = (o.delta - out.middle) / out.half;
    const std::array<double, terms> row{1, x, e, x * e, x * x, e * e, x * e * e, e * e * e, e * e * e * e};
    out.people[static_cast<std::size_t>(o.participant)].add(row, o.score - level);
  }
  for (const auto& sums : out.people) out.all.add(sums, 1);
  return out;
}

/// Least squares of the score on 1, x, e and e^2 (x: log of the mean frame rate; e: its standard deviation,
/// scaled): the start of the search.
std::optional<Place> plane(const Sums& sums) {
  constexpr std::array<std::size_t, 4> used{0, 1, 2, 5};
  std::array<double, 16> gram{};
  std::array<double, 4> moment{};
  for (std::size_t i = 0; i < 4; ++i) {
    moment[i] = sums.moment[used[i]];
    for (std::size_t j = 0; j < 4; ++j) gram[i * 4 + j] = sums.gram[used[i] * terms + used[j]];
  }
  const auto c = solve_positive<4>(gram, moment);
  if (!c || !((*c)[1] > 1e-12)) return std::nullopt;
  return Place{-(*c)[0] / (*c)[1], -(*c)[2] / (*c)[1], -(*c)[3] / (*c)[1], (*c)[1], 0, 0};
}

Result<Place> checked(const Place& at) {
  for (const double value : {at.alpha, at.beta, at.gamma, at.k, at.m, at.q})
    if (!std::isfinite(value)) return Refusal{"the fit left the range of double precision"};
  if (!at.rises()) return Refusal{"the scores do not rise with the frame rate all along the free curve"};
  return at;
}

/// The smallest of the minima that are reached from several starts and at which the score rises with the
/// frame rate.
Result<Place> fit(const Sums& sums) {
  const auto start = plane(sums);
  if (!start)
    return Refusal{"the settings rated do not determine a curve with a bend, or the scores do not rise"};
  Place best;
  double least = std::numeric_limits<double>::infinity();
  for (const double alpha : {start->alpha, -0.4, 0.0, 0.4}) {
    for (const double gamma : {start->gamma, 0.0}) {
      const auto end = descend(sums, Place{alpha, start->beta, gamma, start->k, 0, 0});
      const double value = sums.residuals(end.coefficients());
      if (!(value < least - 1e-9 * sums.squares) || !end.rises()) continue;
      least = value;
      best = end;
    }
  }
  return checked(best);
}

/// The fits without each participant in turn.
Result<std::vector<Place>> leave_one_out(const Ratings& ratings, const Place& whole) {
  std::vector<Place> out;
  for (const auto& person : ratings.people) {
    Sums rest = ratings.all;
    rest.add(person, -1);
    const auto without = checked(descend(rest, whole));
    if (!without)
      return Refusal{"one participant decides whether there is a free curve: without them " +
                     without.reason()};
    out.push_back(*without);
  }
  return out;
}

FreeCurve curve_of(const Ratings& ratings, const Place& whole, const std::vector<Place>& without,
                   double confidence) {
  FreeCurve out;
  out.middle = ratings.middle;
  out.half = ratings.half;
  out.at = {whole.alpha + ratings.centre, whole.beta, whole.gamma};
  out.participants = static_cast<int>(without.size());
  out.confidence = confidence;
  std::array<std::vector<double>, 3> parts;
  for (const auto& place : without) {
    parts[0].push_back(place.alpha);
    parts[1].push_back(place.beta);
    parts[2].push_back(place.gamma);
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out.covariance[i * 3 + j] = jackknife_covariance(parts[i], parts[j]);
  return out;
}

}  // namespace

double FreeCurve::mu(double delta) const {
  const double e = (delta - middle) / half;
  return std::exp(at[0] + e * (at[1] + e * at[2]));
}

BandPoint FreeCurve::band(double delta) const {
  use_gsl_codes();
  const double e = (delta - middle) / half, n = participants;
  const std::array<double, 3> row{1, e, e * e};
  double variance = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) variance += row[i] * row[j] * covariance[i * 3 + j];
  const double se = std::sqrt(std::max(variance, 0.0));
  const double t = student_quantile(0.5 + confidence / 2, n - 1) * se;
  const double whole = std::sqrt(3 * (n - 1) / (n - 3) * gsl_cdf_fdist_Pinv(confidence, 3, n - 3)) * se;
  const double here = mu(delta);
  return {delta,
          here,
          {here * std::exp(-t), here * std::exp(t)},
          {here * std::exp(-whole), here * std::exp(whole)}};
}

bool FormTest::rejected() const { return p < form_level; }

Result<FormTest> form_test(std::span<const PilotObservation> observations, const Curve& curve, double level,
                           double confidence) {
  const auto ratings = collect(near_curve(observations, curve), level);
  if (!ratings)
    return Refusal{"the curve runs through the frame rates shown at fewer than three standard deviations"};
  const int n = static_cast<int>(ratings->people.size());
  if (n < least_participants)
    return Refusal{"a test over participants needs at least " + std::to_string(least_participants) +
                   " of them, not " + std::to_string(n)};
  const auto whole = fit(ratings->all);
  if (!whole) return Refusal{whole.reason()};
  const auto without = leave_one_out(*ratings, *whole);
  if (!without) return Refusal{without.reason()};
  FormTest out;
  out.curve = curve_of(*ratings, *whole, *without, confidence);
  out.c = out.curve.at[2];
  out.se = std::sqrt(out.curve.covariance[8]);
  if (!(out.se > 1e-9)) return Refusal{"the participants agree: the bend has no spread"};
  out.t = out.c / out.se;
  out.df = n - 1;
  use_gsl_codes();
  out.p = 2 * gsl_cdf_tdist_Q(std::abs(out.t), out.df);
  const double reach = student_quantile(0.5 + confidence / 2, out.df) * out.se;
  out.ci = {out.c - reach, out.c + reach};
  const auto smallest = t_detectable(n, form_power, form_level, Design::OneSample);
  if (!smallest) return Refusal{smallest.reason()};
  out.detectable = *smallest * std::sqrt(static_cast<double>(n)) * out.se;
  return out;
}

}  // namespace stats
