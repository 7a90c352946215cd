#include "stats/ptpe/placement.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace stats {
namespace {

constexpr int grid_points = 13;
constexpr double largest_b = 0.1;  // s/frame

/// Share of this person's own estimate in the estimated contour; the rest is that of all people.
constexpr double own_share = 1.0 / 3;
/// Trials at the ends: whether a trial uses the smallest standard deviation. The contour there is a, and b is
/// its slope, so that trials at the smallest one determine both.
constexpr std::array at_smallest{true, false, true, true};
/// Distances of successive trials of one kind from the estimated contour, as exponents of
/// PlacementRules::bracket.
constexpr std::array smallest_distances{1, 0, -1}, inner_distances{0, 1, -1};
constexpr std::array largest_distances{1, -1};
/// Place of a trial between the ends within its share of the session, [0, 1).
constexpr double inner_place = 0.75;

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

/// The standard deviation of the trials between the ends: the middle one of those between the smallest and
/// the largest. Empty if there is none. `deltas` is ascending.
std::optional<double> inner_delta(const std::vector<double>& deltas) {
  if (deltas.size() < 3) return std::nullopt;
  return deltas[(deltas.size() - 1) / 2];
}

/// Number of trials between the ends among the first `trials` ones of a session. Trial j of them is at
/// (j + inner_place) trials / between.
int inner_before(const PlacementRules& rules, int trials) {
  int count = 0;
  while (count < rules.between &&
         static_cast<int>((count + inner_place) * rules.trials / rules.between) < trials)
    ++count;
  return count;
}

/// The standard deviation of a trial, and its distance from the estimated contour as an exponent of
/// PlacementRules::bracket.
struct PlacementTurn {
  double delta = 0;
  int distance = 0;
};

PlacementTurn turn_of(const PlacementRules& rules, const std::vector<double>& deltas, int person, int trial) {
  const auto nth = [](const auto& values, int n) {
    return values[static_cast<std::size_t>(n) % values.size()];
  };
  const auto inner = inner_delta(deltas);
  const int before = inner ? inner_before(rules, trial) : 0;
  if (inner && inner_before(rules, trial + 1) > before)
    return {*inner, nth(inner_distances, before + person)};
  const int ends = trial - before;
  const bool smallest = nth(at_smallest, ends);
  int same = person;  // trials at this end before, shifted by the person's number
  for (int t = 0; t < ends; ++t) same += nth(at_smallest, t) == smallest;
  return smallest ? PlacementTurn{deltas.front(), nth(smallest_distances, same)}
                  : PlacementTurn{deltas.back(), nth(largest_distances, same)};
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

int usual_between(int trials) { return std::min(trials, std::max(2, (2 * trials + 5) / 10)); }

Placement::Placement(std::vector<PlacementSetting> settings, const PlacementPrior& prior,
                     const PlacementRules& rules)
    : settings_(std::move(settings)),
      rules_(rules),
      lowest_(prior.lowest),
      all_(make_quest(settings_, prior)),
      own_(all_) {
  if (!(rules.bracket > 1) || rules.trials < 1 || rules.between < 0 || rules.between > rules.trials ||
      rules.most_of_one < 1)
    throw std::invalid_argument(
        "Placement: a rule is out of range; set bracket above 1, trials and most_of_one from 1 and between "
        "from 0 to trials");
  for (const PlacementSetting& one : settings_) deltas_.push_back(one.delta);
  std::ranges::sort(deltas_);
  deltas_.erase(std::unique(deltas_.begin(), deltas_.end()), deltas_.end());
  for (const PlacementPoint& point : points_of(prior)) {
    a_values_.push_back(point.a);
    b_values_.push_back(point.b);
  }
}

void Placement::set_person(int person) {
  if (person < 0)
    throw std::invalid_argument("Placement::set_person: a negative number; count people from 0");
  person_ = person;
}

int Placement::next() const {
  const auto [delta, distance] = turn_of(rules_, deltas_, person_, static_cast<int>(shown_.size()));
  const double own_a = grid_estimate(a_values_, own_.posterior()).mean;
  const double own_b = grid_estimate(b_values_, own_.posterior()).mean;
  const double contour = std::exp(std::lerp(std::log(a().mean), std::log(own_a), own_share) +
                                  std::lerp(b().mean, own_b, own_share) * delta);
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

void Placement::learn(int setting, int score) { all_.update(setting, score - lowest_); }

void Placement::add(int setting, int score) {
  learn(setting, score);
  own_.update(setting, score - lowest_);
  shown_.push_back(setting);
}

GridEstimate Placement::a() const { return grid_estimate(a_values_, all_.posterior()); }
GridEstimate Placement::b() const { return grid_estimate(b_values_, all_.posterior()); }

}  // namespace stats
