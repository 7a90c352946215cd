#include "stats/ptpe/people_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/ordinal/gauss_hermite.hpp"
#include "stats/ordinal/level_thresholds.hpp"

namespace stats {

namespace {

using Pair = std::array<double, 2>;

/// Sum over a person's rows of the log-likelihood, with its slope and curvature for the effects (e_a, e_b) by
/// which alpha_p = alpha + e_a, beta_p = beta + e_b.
struct PersonSum {
  double value = 0;
  Pair slope{};
  std::array<double, 3> curvature{};  ///< minus the second derivatives: aa, ab, bb
  /// The same without rows that bend the other way, so that it is never negative.
  std::array<double, 3> held{};
};

}  // namespace

/// All parameters of one evaluation, in the terms that the rows need.
struct PeopleLikelihood::Place {
  const PeopleRows& rows;
  std::span<const double> p;  ///< the parameters after the log gaps
  LevelThresholds scale;
  Lapses lapses;
  double by_root = 0;    ///< derivative of the lapse rate for its parameter
  double l11, l21, l22;  ///< (e_a, e_b) = (l11 u_1, l21 u_1 + l22 u_2) with u standard normal
  double rho, rest;      ///< correlation, and sqrt(1 - rho^2)

  Place(const PeopleRows& all, std::span<const double> at, double level, double least_lapse)
      : rows(all), p(at.subspan(all.gaps())) {
    scale = level_thresholds(at.first(all.gaps()), 0, all.levels, level);
    lapses = {lapse_rate(p[PeopleAt::LapseRoot], least_lapse, by_root), all.choices};
    const double sd_b = std::exp(p[PeopleAt::LogSdB]);
    rho = std::tanh(p[PeopleAt::ArtanhR]);
    rest = 1 / std::cosh(p[PeopleAt::ArtanhR]);
    l11 = std::exp(p[PeopleAt::LogSdA]);
    l21 = rho * sd_b;
    l22 = rest * sd_b;
  }

  Pair effects(const Pair& u) const { return {l11 * u[0], l21 * u[0] + l22 * u[1]}; }

  double v(std::size_t row, const Pair& e) const {
    return rows.x[row] - p[PeopleAt::Alpha] - e[0] - (p[PeopleAt::Beta] + e[1]) * rows.d[row];
  }
  /// Derivative of the location for v.
  double by_v(std::size_t row, double at) const {
    return p[PeopleAt::K] + p[PeopleAt::M] * rows.d[row] + 2 * p[PeopleAt::Q] * at;
  }
  CategoryTerm term(std::size_t row, double at) const {
    const auto c = static_cast<std::size_t>(rows.category[row]);
    const double location = at * (p[PeopleAt::K] + p[PeopleAt::M] * rows.d[row] + p[PeopleAt::Q] * at) +
                            p[PeopleAt::Drift] * rows.position[row];
    const auto attentive = category_term(Link::Probit, c ? scale.theta[c - 1] : -HUGE_VAL,
                                         c < scale.theta.size() ? scale.theta[c] : HUGE_VAL, location);
    return lapses.rate > 0 ? with_lapses(attentive, lapses) : attentive;
  }
  PersonSum sum(const std::vector<std::size_t>& of, const Pair& e) const {
    PersonSum out;
    for (const std::size_t row : of) {
      const double at = v(row, e), slope = by_v(row, at), d = rows.d[row];
      const auto t = term(row, at);
      out.value += t.log_p;
      out.slope[0] -= t.d1 * slope;
      out.slope[1] -= t.d1 * slope * d;
      const double bend = -(t.d2 * slope * slope + 2 * t.d1 * p[PeopleAt::Q]), held = std::max(bend, 0.0);
      const std::array<double, 3> shape{1, d, d * d};
      for (std::size_t i = 0; i < 3; ++i) {
        out.curvature[i] += bend * shape[i];
        out.held[i] += held * shape[i];
      }
    }
    return out;
  }
  /// Slope for u, and minus the curvature for u of the exponent g(u) = sum log P - |u|^2 / 2.
  Pair slope_u(const PersonSum& s, const Pair& u) const {
    return {l11 * s.slope[0] + l21 * s.slope[1] - u[0], l22 * s.slope[1] - u[1]};
  }
  std::array<double, 3> curvature_u(const std::array<double, 3>& c) const {
    return {1 + l11 * l11 * c[0] + 2 * l11 * l21 * c[1] + l21 * l21 * c[2], l22 * (l11 * c[1] + l21 * c[2]),
            1 + l22 * l22 * c[2]};
  }
  /// The curvature at s; where the integrand is flatter than the normal density in some direction, that of
  /// the rows that bend the right way.
  std::array<double, 3> safe_curvature(const PersonSum& s) const {
    const auto c = curvature_u(s.curvature);
    if (c[0] >= 1 && c[2] >= 1 && (c[0] - 1) * (c[2] - 1) >= c[1] * c[1]) return c;
    return curvature_u(s.held);
  }
};

PeopleLikelihood::PeopleLikelihood(const PeopleRows& rows, double level, double least_lapse, int points)
    : rows_(rows), level_(level), least_lapse_(least_lapse) {
  const auto rule = gauss_hermite(points);
  nodes_ = rule.nodes;
  log_weights_ = rule.log_weights;
  people_.resize(static_cast<std::size_t>(rows.people));
  for (std::size_t i = 0; i < rows.n(); ++i)
    people_[static_cast<std::size_t>(rows.person[i])].rows.push_back(i);
}

/// Moves person.mode to a maximum of the exponent and sets the spread of the nodes from its curvature.
/// Returns false if the exponent is not finite.
bool PeopleLikelihood::find_mode(Person& person, const Place& place) const {
  const auto exponent = [](const PersonSum& s, const Pair& u) {
    return s.value - (u[0] * u[0] + u[1] * u[1]) / 2;
  };
  auto here = place.sum(person.rows, place.effects(person.mode));
  if (!std::isfinite(here.value)) {
    person.mode = {};
    here = place.sum(person.rows, {});
  }
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double g = exponent(here, person.mode);
    if (!std::isfinite(g)) return false;
    const auto slope = place.slope_u(here, person.mode);
    const auto c = place.safe_curvature(here);
    const double determinant = c[0] * c[2] - c[1] * c[1];
    Pair step{(c[2] * slope[0] - c[1] * slope[1]) / determinant,
              (c[0] * slope[1] - c[1] * slope[0]) / determinant};
    if (std::hypot(step[0], step[1]) < 1e-10) break;
    bool moved = false;
    for (int half = 0; half < 40 && !moved; ++half) {
      const Pair u{person.mode[0] + step[0], person.mode[1] + step[1]};
      const auto next = place.sum(person.rows, place.effects(u));
      moved = exponent(next, u) >= g - 1e-13 * std::abs(g);
      if (moved) {
        person.mode = u;
        here = next;
      }
      for (double& s : step) s /= 2;
    }
    if (!moved) break;
  }
  // The covariance of the nodes is the inverse of c. Its Cholesky factor:
  const auto c = place.safe_curvature(here);
  const double determinant = c[0] * c[2] - c[1] * c[1];
  person.spread[0] = std::sqrt(c[2] / determinant);
  person.spread[1] = -c[1] / determinant / person.spread[0];
  person.spread[2] = 1 / std::sqrt(c[2]);
  return true;
}

double PeopleLikelihood::add_person(Person& person, const Place& place, MixedGradient& scale,
                                    std::span<double> slopes, PersonMoments& moments) const {
  if (follow_ && !find_mode(person, place)) return -HUGE_VAL;
  const std::size_t points = nodes_.size(), n = person.rows.size();
  std::vector<CategoryTerm> terms(points * points * n);
  std::vector<double> share(points * points);
  std::vector<Pair> u(points * points);
  double largest = -HUGE_VAL, total = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double z0 = nodes_[k / points], z1 = nodes_[k % points];
    u[k] = {person.mode[0] + person.spread[0] * z0,
            person.mode[1] + person.spread[1] * z0 + person.spread[2] * z1};
    share[k] =
        log_weights_[k / points] + log_weights_[k % points] - (u[k][0] * u[k][0] + u[k][1] * u[k][1]) / 2;
    const Pair e = place.effects(u[k]);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t row = person.rows[i];
      terms[k * n + i] = place.term(row, place.v(row, e));
      share[k] += terms[k * n + i].log_p;
    }
    largest = std::max(largest, share[k]);
  }
  if (!std::isfinite(largest)) return -HUGE_VAL;
  for (double& s : share) total += s = std::exp(s - largest);
  Pair mean{}, squares{};
  double cross = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double w = share[k] /= total;
    const Pair e = place.effects(u[k]);
    mean[0] += w * e[0];
    mean[1] += w * e[1];
    squares[0] += w * e[0] * e[0];
    squares[1] += w * e[1] * e[1];
    cross += w * e[0] * e[1];
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t row = person.rows[i];
      const CategoryTerm& t = terms[k * n + i];
      const auto c = static_cast<std::size_t>(rows_.category[row]);
      if (c < scale.thresholds.size()) scale.thresholds[c] += w * t.up;
      if (c) scale.thresholds[c - 1] += w * t.lo;
      const double d = rows_.d[row], at = place.v(row, e), g = w * t.d1, by_e = -g * place.by_v(row, at);
      slopes[PeopleAt::Alpha] += by_e;
      slopes[PeopleAt::Beta] += by_e * d;
      slopes[PeopleAt::K] += g * at;
      slopes[PeopleAt::M] += g * at * d;
      slopes[PeopleAt::Q] += g * at * at;
      slopes[PeopleAt::Drift] += g * rows_.position[row];
      slopes[PeopleAt::LogSdA] += by_e * e[0];
      slopes[PeopleAt::LogSdB] += by_e * d * e[1];
      slopes[PeopleAt::ArtanhR] +=
          by_e * d * (place.l22 * place.rest * u[k][0] - place.rho * place.l22 * u[k][1]);
      if (place.lapses.rate > 0) {
        const double p = std::exp(t.log_p), guess = 1.0 / place.lapses.choices;
        const double attentive = (p - place.lapses.rate * guess) / (1 - place.lapses.rate);
        slopes[PeopleAt::LapseRoot] += w * (guess - attentive) / p * place.by_root;
      }
    }
  }
  moments.mean = {place.p[PeopleAt::Alpha] + mean[0], place.p[PeopleAt::Beta] + mean[1]};
  moments.var_alpha = squares[0] - mean[0] * mean[0];
  moments.var_beta = squares[1] - mean[1] * mean[1];
  moments.cov = cross - mean[0] * mean[1];
  return largest + std::log(total) + std::log(person.spread[0] * person.spread[2]);
}

double PeopleLikelihood::evaluate(std::span<const double> at, std::span<double> gradient) {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  for (std::size_t i = 0; i < at.size(); ++i)
    if (!(std::abs(at[i]) < 50)) return -HUGE_VAL;
  for (const double gap : at.first(rows_.gaps()))
    if (std::abs(gap) > 10) return -HUGE_VAL;
  const Place place(rows_, at, level_, least_lapse_);
  MixedGradient scale;
  scale.thresholds.assign(place.scale.theta.size(), 0);
  std::vector<PersonMoments> moments(people_.size());
  double value = 0;
  for (std::size_t p = 0; p < people_.size(); ++p) {
    value += add_person(people_[p], place, scale, gradient.subspan(rows_.gaps()), moments[p]);
    if (!std::isfinite(value)) return -HUGE_VAL;
  }
  place.scale.by_gaps(at.first(rows_.gaps()), scale.thresholds, gradient.first(rows_.gaps()));
  moments_ = std::move(moments);
  return value;
}

double PeopleLikelihood::of_person(int person, std::span<const double> at, std::array<double, 2> own,
                                   std::array<double, 2>& slope) const {
  const Place place(rows_, at, level_, least_lapse_);
  const auto sum = place.sum(people_[static_cast<std::size_t>(person)].rows,
                             {own[0] - place.p[PeopleAt::Alpha], own[1] - place.p[PeopleAt::Beta]});
  slope = sum.slope;
  return std::isfinite(sum.value) ? sum.value : -HUGE_VAL;
}

}  // namespace stats
