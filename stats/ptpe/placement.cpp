#include "stats/ptpe/placement.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace stats {
namespace {

constexpr int grid_points = 13;
constexpr double largest_b = 0.1;  // s/frame

/// Trials at the ends: whether a trial uses the smallest standard deviation. The contour there is a, and b is
/// its slope, so that trials at the smallest one determine both.
constexpr std::array at_smallest{true, true, false, true};
/// Distances of successive trials from the estimated contour, as exponents of PlacementRules::bracket.
constexpr std::array end_distances{1, 0, -1}, inner_distances{0, 1, -1};

struct PlacementPoint {
  double a = 0, b = 0, slope = 0;
};

std::vector<PlacementPoint> points_of(const PlacementPrior& prior) {
  std::vector<PlacementPoint> out;
  for (const double a : prior.a)
    for (const double b : prior.b)
      for (const double slope : prior.slope) out.push_back({a, b, slope});
  return out;
}

/// P(score) of a rating with this mean: the normal distribution between the midpoints of the scores; the
/// lowest and the highest score take its tails.
double chance_of(const PlacementPrior& prior, double mean, int score) {
  const auto below = [&](double x) { return gsl_cdf_ugaussian_P((x - mean) / prior.noise); };
  const double upper = score == prior.highest ? 1 : below(score + 0.5);
  return std::clamp(upper - (score == prior.lowest ? 0 : below(score - 0.5)), 0.0, 1.0);
}

QuestPlus make_quest(const std::vector<PlacementSetting>& settings, const PlacementPrior& prior) {
  const auto points = points_of(prior);
  const std::vector<double> even(points.size(), 1.0);
  const auto chance = [&](int s, int p, int o) {
    const PlacementSetting& setting = settings[static_cast<std::size_t>(s)];
    const PlacementPoint& point = points[static_cast<std::size_t>(p)];
    const double tau = setting.mu - point.a * std::exp(point.b * setting.delta);
    return chance_of(prior, prior.level + point.slope * tau, prior.lowest + o);
  };
  return {static_cast<int>(settings.size()), prior.highest - prior.lowest + 1, even, chance};
}

/// The standard deviation of trial `trial` among those between the ends: the middle one first, then the
/// others by their distance from it. `deltas` has at least three.
double inner_delta(const std::vector<double>& deltas, std::size_t trial) {
  std::vector<double> inner(deltas.begin() + 1, deltas.end() - 1);
  const double middle = inner[(inner.size() - 1) / 2];
  std::ranges::stable_sort(inner, {}, [&](double delta) { return std::abs(delta - middle); });
  return inner[trial % inner.size()];
}

}  // namespace

PlacementPrior placement_prior(std::span<const PlacementSetting> settings) {
  if (settings.size() < 2)
    throw std::invalid_argument("placement_prior: fewer than two settings; give at least two");
  double low = HUGE_VAL, high = 0, delta = 0;
  for (const PlacementSetting& one : settings) {
    low = std::min(low, one.mu);
    high = std::max(high, one.mu);
    delta = std::max(delta, one.delta);
  }
  if (!(low > 0 && high > low))
    throw std::invalid_argument(
        "placement_prior: all means are equal, or one is not above 0; give settings of different means above "
        "0");
  PlacementPrior prior;
  const double last_b = delta > 0 ? std::min(largest_b, std::log(high / low) / delta) : 0;
  for (int i = 0; i < grid_points; ++i) {
    const double share = static_cast<double>(i) / (grid_points - 1);
    prior.a.push_back(low / 2 * std::pow(2 * high / low, share));
    if (i == 0 || last_b > 0) prior.b.push_back(share * last_b);
  }
  return prior;
}

Placement::Placement(std::vector<PlacementSetting> settings, const PlacementPrior& prior,
                     const PlacementRules& rules)
    : settings_(std::move(settings)),
      rules_(rules),
      lowest_(prior.lowest),
      quest_(make_quest(settings_, prior)) {
  if (!(rules.bracket > 1) || rules.between < 0 || rules.most_of_one < 1)
    throw std::invalid_argument(
        "Placement: a rule is out of range; set bracket above 1, between from 0 and most_of_one from 1");
  for (const PlacementSetting& one : settings_) deltas_.push_back(one.delta);
  std::ranges::sort(deltas_);
  deltas_.erase(std::unique(deltas_.begin(), deltas_.end()), deltas_.end());
  for (const PlacementPoint& point : points_of(prior)) {
    a_values_.push_back(point.a);
    b_values_.push_back(point.b);
  }
}

int Placement::next() const {
  const std::size_t trial = shown_.size();
  const std::size_t between = deltas_.size() > 2 ? static_cast<std::size_t>(rules_.between) : 0;
  const bool inner = trial < between;
  const std::size_t turn = inner ? trial : trial - between;
  const double delta = inner                                    ? inner_delta(deltas_, trial)
                       : at_smallest[turn % at_smallest.size()] ? deltas_.front()
                                                                : deltas_.back();
  // The two cycles have no common divisor, so that both ends meet all distances from the contour.
  const int distance = (inner ? inner_distances : end_distances)[turn % end_distances.size()];
  const double contour = a().mean * std::exp(b().mean * delta);
  const double wanted = contour * std::pow(rules_.bracket, distance);
  // Finds the setting nearest to `wanted`. A setting of another standard deviation (delta) is taken only if
  // none of this one may be shown again.
  constexpr double other_delta = 1e3;
  int best = -1;
  double least = 0;
  for (int i = 0; i < static_cast<int>(settings_.size()); ++i) {
    const PlacementSetting& one = settings_[static_cast<std::size_t>(i)];
    if (std::ranges::count(shown_, i) >= rules_.most_of_one) continue;
    const double far = std::abs(std::log(one.mu / wanted)) + other_delta * std::abs(one.delta - delta);
    if (best < 0 || far < least) {
      best = i;
      least = far;
    }
  }
  if (best < 0)
    throw std::logic_error(
        "Placement::next: every setting was shown as often as the rules allow; end the session or raise "
        "PlacementRules::most_of_one");
  return best;
}

void Placement::add(int setting, int score) {
  quest_.update(setting, score - lowest_);
  shown_.push_back(setting);
}

GridEstimate Placement::a() const { return grid_estimate(a_values_, quest_.posterior()); }
GridEstimate Placement::b() const { return grid_estimate(b_values_, quest_.posterior()); }

}  // namespace stats
