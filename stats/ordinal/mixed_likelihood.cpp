#include "stats/ordinal/mixed_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/ordinal/gauss_hermite.hpp"

namespace stats {

namespace {

/// The exponent of the integrand over a participant's effect u, g(u) = sum log P(row | u) - u^2 / 2, and its
/// derivatives.
struct Exponent {
  double g = 0, d1 = 0, d2 = 0, d3 = 0;
};

/// Derivatives for the lapse rate: of log P, and of its first two derivatives for the location.
struct ByLapse {
  double value = 0, d1 = 0, d2 = 0;
};

/// `t`: a term with lapses.
ByLapse by_lapse(const CategoryTerm& t, const Lapses& lapses) {
  const double p = std::exp(t.log_p), guess = 1.0 / lapses.choices;
  const double value = (guess - (p - lapses.rate * guess) / (1 - lapses.rate)) / p;
  const double change = -(1 / (1 - lapses.rate) + value);
  const double d1 = change * t.d1;
  return {value, d1, change * (t.d2 + t.d1 * t.d1) - 2 * t.d1 * d1};
}

}  // namespace

double lapse_rate(double root, double least, double& slope) {
  const double s = 1 + root * root, range = largest_lapse - least;
  slope = range * 2 * root / (s * s);
  return least + range * root * root / s;
}

CategoryTerm with_lapses(const CategoryTerm& attentive, const Lapses& lapses) {
  const double likely = (1 - lapses.rate) * std::exp(attentive.log_p);
  const double p = likely + lapses.rate / lapses.choices;
  CategoryTerm t;
  t.log_p = std::log(p);
  if (!(likely > 0)) return t;
  // Derivatives of P divided by P are those of the attentive term times its share of P.
  const double share = likely / p;
  const double a1 = attentive.d1, a2 = attentive.d2 + a1 * a1,
               a3 = attentive.d3 + 3 * a1 * a2 - 2 * a1 * a1 * a1;
  const double n1 = share * a1, n2 = share * a2, n3 = share * a3;
  t.d1 = n1;
  t.d2 = n2 - n1 * n1;
  t.d3 = n3 - 3 * n2 * n1 + 2 * n1 * n1 * n1;
  const auto threshold = [&](double up, double up1, double up2, double& d, double& d_v, double& d_vv) {
    const double slope = up1 + up * a1, curve = up2 + 2 * slope * a1 + up * a2 - 2 * up * a1 * a1;
    d = share * up;
    d_v = share * slope - d * n1;
    d_vv = share * curve - 2 * share * slope * n1 - d * n2 + 2 * d * n1 * n1;
  };
  threshold(attentive.up, attentive.up1, attentive.up2, t.up, t.up1, t.up2);
  threshold(attentive.lo, attentive.lo1, attentive.lo2, t.lo, t.lo1, t.lo2);
  return t;
}

struct MixedLikelihood::Place {
  std::span<const double> thresholds, location;
  double sd;
  Link link;
  const std::vector<int>& category;
  Lapses lapses;

  CategoryTerm attentive(std::size_t row, double u) const {
    const auto c = static_cast<std::size_t>(category[row]);
    return category_term(link, c ? thresholds[c - 1] : -HUGE_VAL,
                         c < thresholds.size() ? thresholds[c] : HUGE_VAL, location[row] + sd * u);
  }
  CategoryTerm term(std::size_t row, double u) const {
    return lapses.rate > 0 ? with_lapses(attentive(row, u), lapses) : attentive(row, u);
  }
  /// `terms`: receives the terms of the rows; null: nothing does.
  Exponent exponent(const std::vector<std::size_t>& rows, double u, CategoryTerm* terms = nullptr) const {
    Exponent e{-u * u / 2, -u, -1, 0};
    for (const std::size_t row : rows) {
      const auto t = term(row, u);
      if (terms) *terms++ = t;
      e.g += t.log_p;
      e.d1 += sd * t.d1;
      e.d2 += sd * sd * t.d2;
      e.d3 += sd * sd * sd * t.d3;
    }
    return e;
  }
};

MixedLikelihood::MixedLikelihood(std::span<const int> category, std::span<const int> participant, Link link,
                                 int points)
    : category_(category.begin(), category.end()), link_(link) {
  if (points < 1 || category.size() != participant.size() || category.empty()) {
    throw std::invalid_argument(
        "MixedLikelihood: no rows, not one participant for each, or no nodes; give both columns one length "
        "above 0, and points from 1");
  }
  groups_.resize(static_cast<std::size_t>(*std::max_element(participant.begin(), participant.end())) + 1);
  for (std::size_t i = 0; i < participant.size(); ++i)
    groups_[static_cast<std::size_t>(participant[i])].rows.push_back(i);
  auto rule = gauss_hermite(points);
  nodes_ = std::move(rule.nodes);
  log_weights_ = std::move(rule.log_weights);
}

/// Moves group.mode to the maximum of g, the concave exponent of the integrand over the participant's effect,
/// by Newton's method. Returns false if g or its slope d1 is not finite.
bool MixedLikelihood::find_mode(Group& group, const Place& place) const {
  auto here = place.exponent(group.rows, group.mode);
  if (!std::isfinite(here.g)) {
    group.mode = 0;
    here = place.exponent(group.rows, 0);
  }
  for (int iteration = 0; iteration < 100; ++iteration) {
    if (!std::isfinite(here.g) || !std::isfinite(here.d1)) return false;
    double step = here.d1 / std::max(-here.d2, 1.0);  // -d2 is at least 1 without lapses
    if (std::abs(step) < 1e-12 * (1 + std::abs(group.mode))) return true;
    for (;; step /= 2) {
      const auto next = place.exponent(group.rows, group.mode + step);
      if (next.g >= here.g - 1e-13 * std::abs(here.g)) {
        group.mode += step;
        here = next;
        break;
      }
      if (std::abs(step) < 1e-13) return true;
    }
  }
  return true;
}

double MixedLikelihood::add_group(Group& group, const Place& place, MixedGradient& gradient) {
  if (!find_mode(group, place)) return -HUGE_VAL;
  const double u = group.mode, sd = place.sd;
  const std::size_t points = nodes_.size(), rows = group.rows.size();
  std::vector<CategoryTerm> mode_terms(rows), node_terms(points * rows);
  const auto at_mode = place.exponent(group.rows, u, mode_terms.data());
  const double curvature = std::max(-at_mode.d2, 1.0), scale = 1 / std::sqrt(curvature);
  const bool held = -at_mode.d2 < 1;  // the scale does not follow the curvature
  std::vector<Exponent> at(points);
  std::vector<double> share(points);
  double largest = -HUGE_VAL, sum = 0;
  for (std::size_t k = 0; k < points; ++k) {
    at[k] = place.exponent(group.rows, u + scale * nodes_[k], &node_terms[k * rows]);
    share[k] = log_weights_[k] + at[k].g;
    largest = std::max(largest, share[k]);
  }
  if (!std::isfinite(largest)) return -HUGE_VAL;
  for (double& s : share) sum += s = std::exp(s - largest);
  for (double& s : share) s /= sum;
  // With g the exponent of the integrand and u_k the nodes: d log L = sum share d g(u_k) + by_slope d
  // g'(mode) + by_curvature d g''(mode), since the mode moves by d g' / curvature and the scale changes with
  // g''.
  double a = 0, b = 1;
  for (std::size_t k = 0; k < points; ++k) {
    a += share[k] * at[k].d1;
    b += share[k] * at[k].d1 * scale * nodes_[k];
  }
  const double by_curvature = held ? 0 : b / (2 * curvature);
  const double by_slope = (a + by_curvature * at_mode.d3) / std::max(-at_mode.d2, 1e-3);
  const bool lapses = place.lapses.rate > 0;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row = group.rows[i];
    const auto c = static_cast<std::size_t>(category_[row]);
    const CategoryTerm& m = mode_terms[i];
    double up = sd * by_slope * m.up1 + sd * sd * by_curvature * m.up2;
    double lo = sd * by_slope * m.lo1 + sd * sd * by_curvature * m.lo2;
    double location = sd * by_slope * m.d2 + sd * sd * by_curvature * m.d3;
    gradient.sd += by_slope * (m.d1 + sd * u * m.d2) + by_curvature * (2 * sd * m.d2 + sd * sd * u * m.d3);
    if (lapses) {
      const auto by = by_lapse(m, place.lapses);
      gradient.lapse += sd * by_slope * by.d1 + sd * sd * by_curvature * by.d2;
    }
    for (std::size_t k = 0; k < points; ++k) {
      const double node = u + scale * nodes_[k];
      const CategoryTerm& t = node_terms[k * rows + i];
      if (lapses) gradient.lapse += share[k] * by_lapse(t, place.lapses).value;
      up += share[k] * t.up;
      lo += share[k] * t.lo;
      location += share[k] * t.d1;
      gradient.sd += share[k] * node * t.d1;
    }
    gradient.location[row] += location;
    if (c < gradient.thresholds.size()) gradient.thresholds[c] += up;
    if (c) gradient.thresholds[c - 1] += lo;
  }
  return largest + std::log(sum) + std::log(scale);
}

double MixedLikelihood::evaluate(std::span<const double> thresholds, std::span<const double> location,
                                 double sd, MixedGradient& gradient, const Lapses& lapses) {
  gradient.thresholds.assign(thresholds.size(), 0);
  gradient.location.assign(location.size(), 0);
  gradient.sd = gradient.lapse = 0;
  const auto falls = std::adjacent_find(thresholds.begin(), thresholds.end(), std::greater_equal<>());
  if (falls != thresholds.end() || !std::isfinite(sd)) return -HUGE_VAL;
  if (!(lapses.rate >= 0 && lapses.rate < 1)) return -HUGE_VAL;
  const Place place{thresholds, location, sd, link_, category_, lapses};
  std::vector<double> each;
  double log_likelihood = 0;
  for (auto& group : groups_) {
    each.push_back(add_group(group, place, gradient));
    log_likelihood += each.back();
    if (!std::isfinite(log_likelihood)) return -HUGE_VAL;
  }
  by_participant_ = std::move(each);
  return log_likelihood;
}

}  // namespace stats
