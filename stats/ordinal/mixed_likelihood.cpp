#include "stats/ordinal/mixed_likelihood.hpp"

#include <gsl/gsl_integration.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <stdexcept>

#include "stats/gsl_errors.hpp"

namespace stats {

namespace {

/// The exponent of the integrand over a participant's effect u, g(u) = sum log P(row | u) - u^2 / 2, and its
/// derivatives.
struct Exponent {
  double g = 0, d1 = 0, d2 = 0, d3 = 0;
};

}  // namespace

struct MixedLikelihood::Place {
  std::span<const double> thresholds, location;
  double sd;
  Link link;
  const std::vector<int>& category;

  CategoryTerm term(std::size_t row, double u) const {
    const auto c = static_cast<std::size_t>(category[row]);
    return category_term(link, c ? thresholds[c - 1] : -HUGE_VAL,
                         c < thresholds.size() ? thresholds[c] : HUGE_VAL, location[row] + sd * u);
  }
  Exponent exponent(const std::vector<std::size_t>& rows, double u) const {
    Exponent e{-u * u / 2, -u, -1, 0};
    for (const std::size_t row : rows) {
      const auto t = term(row, u);
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
  use_gsl_codes();
  if (points < 1 || category.size() != participant.size() || category.empty()) {
    throw std::invalid_argument(
        "MixedLikelihood: no rows, not one participant for each, or no nodes; give both columns one length "
        "above 0, and points from 1");
  }
  groups_.resize(static_cast<std::size_t>(*std::max_element(participant.begin(), participant.end())) + 1);
  for (std::size_t i = 0; i < participant.size(); ++i)
    groups_[static_cast<std::size_t>(participant[i])].rows.push_back(i);
  const std::unique_ptr<gsl_integration_fixed_workspace, decltype(&gsl_integration_fixed_free)> rule(
      gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, static_cast<std::size_t>(points), 0, 1, 0,
                                  0),
      &gsl_integration_fixed_free);
  if (!rule) throw std::bad_alloc();
  for (int k = 0; k < points; ++k) {
    const double z = gsl_integration_fixed_nodes(rule.get())[k];
    const double w = gsl_integration_fixed_weights(rule.get())[k];
    nodes_.push_back(std::numbers::sqrt2 * z);
    log_weights_.push_back(std::log(w) + z * z - std::log(std::numbers::pi) / 2);
  }
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
    double step = -here.d1 / here.d2;
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
  const auto at_mode = place.exponent(group.rows, u);
  const double curvature = -at_mode.d2, scale = 1 / std::sqrt(curvature);
  const std::size_t points = nodes_.size();
  std::vector<Exponent> at(points);
  std::vector<double> share(points);
  double largest = -HUGE_VAL, sum = 0;
  for (std::size_t k = 0; k < points; ++k) {
    at[k] = place.exponent(group.rows, u + scale * nodes_[k]);
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
  const double by_curvature = b / (2 * curvature);
  const double by_slope = (a + by_curvature * at_mode.d3) / curvature;
  for (const std::size_t row : group.rows) {
    const auto c = static_cast<std::size_t>(category_[row]);
    const auto m = place.term(row, u);
    double up = sd * by_slope * m.up1 + sd * sd * by_curvature * m.up2;
    double lo = sd * by_slope * m.lo1 + sd * sd * by_curvature * m.lo2;
    double location = sd * by_slope * m.d2 + sd * sd * by_curvature * m.d3;
    gradient.sd += by_slope * (m.d1 + sd * u * m.d2) + by_curvature * (2 * sd * m.d2 + sd * sd * u * m.d3);
    for (std::size_t k = 0; k < points; ++k) {
      const double node = u + scale * nodes_[k];
      const auto t = points == 1 ? m : place.term(row, node);
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
                                 double sd, MixedGradient& gradient) {
  gradient.thresholds.assign(thresholds.size(), 0);
  gradient.location.assign(location.size(), 0);
  gradient.sd = 0;
  const auto falls = std::adjacent_find(thresholds.begin(), thresholds.end(), std::greater_equal<>());
  if (falls != thresholds.end() || !std::isfinite(sd)) return -HUGE_VAL;
  const Place place{thresholds, location, sd, link_, category_};
  double log_likelihood = 0;
  for (auto& group : groups_) {
    log_likelihood += add_group(group, place, gradient);
    if (!std::isfinite(log_likelihood)) return -HUGE_VAL;
  }
  return log_likelihood;
}

}  // namespace stats
