#include "stats/ptpe/placement.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace stats {
namespace {

constexpr int grid_points = 13;
constexpr double largest_b = 0.1;  // s/frame

struct PlacementPoint {
  double a = 0, b = 0, slope = 0, person = 0;
};

std::vector<PlacementPoint> points_of(const PlacementPrior& prior) {
  std::vector<PlacementPoint> out;
  for (const double a : prior.a)
    for (const double b : prior.b)
      for (const double slope : prior.slope)
        for (const double person : prior.person) out.push_back({a, b, slope, person});
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
  std::vector<double> weights;
  std::vector<int> cells;
  const auto nuisance = static_cast<int>(prior.slope.size() * prior.person.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double z = points[i].person / prior.person_sd;
    weights.push_back(std::exp(-z * z / 2));
    cells.push_back(static_cast<int>(i) / nuisance);
  }
  const auto chance = [&](int s, int p, int o) {
    const PlacementSetting& setting = settings[static_cast<std::size_t>(s)];
    const PlacementPoint& point = points[static_cast<std::size_t>(p)];
    const double tau = setting.mu - point.a * std::exp(point.b * setting.delta);
    return chance_of(prior, prior.level + point.slope * tau + point.person, prior.lowest + o);
  };
  return {static_cast<int>(settings.size()), prior.highest - prior.lowest + 1, weights, chance, cells};
}

}  // namespace

PlacementPrior placement_prior(std::span<const PlacementSetting> settings) {
  if (settings.size() < 2) throw std::invalid_argument("placement needs two settings");
  double low = HUGE_VAL, high = 0, delta = 0;
  for (const PlacementSetting& one : settings) {
    low = std::min(low, one.mu);
    high = std::max(high, one.mu);
    delta = std::max(delta, one.delta);
  }
  if (!(low > 0 && high > low)) throw std::invalid_argument("placement needs settings of different means");
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
                     PlacementGuards guards)
    : settings_(std::move(settings)),
      guards_(std::move(guards)),
      lowest_(prior.lowest),
      quest_(make_quest(settings_, prior)) {
  for (const PlacementPoint& point : points_of(prior)) {
    a_values_.push_back(point.a);
    b_values_.push_back(point.b);
  }
  for (const int index : guards_.fixed)
    if (index < 0 || index >= static_cast<int>(settings_.size()))
      throw std::invalid_argument("a fixed setting does not exist");
}

int Placement::next() const {
  if (shown_.size() < guards_.fixed.size()) return guards_.fixed[shown_.size()];
  double low = HUGE_VAL, high = -HUGE_VAL, all_low = HUGE_VAL, all_high = -HUGE_VAL;
  for (const PlacementSetting& one : settings_) {
    all_low = std::min(all_low, one.delta);
    all_high = std::max(all_high, one.delta);
  }
  for (const int index : shown_) {
    low = std::min(low, settings_[static_cast<std::size_t>(index)].delta);
    high = std::max(high, settings_[static_cast<std::size_t>(index)].delta);
  }
  const bool narrow = !shown_.empty() && high - low < guards_.least_spread * (all_high - all_low);
  std::vector<int> allowed, apart;
  for (int i = 0; i < static_cast<int>(settings_.size()); ++i) {
    if (std::ranges::count(shown_, i) >= guards_.most_of_one) continue;
    allowed.push_back(i);
    const double last = shown_.empty() ? -1 : settings_[static_cast<std::size_t>(shown_.back())].delta;
    if (settings_[static_cast<std::size_t>(i)].delta != last) apart.push_back(i);
  }
  if (allowed.empty()) throw std::logic_error("every setting was shown as often as the guards allow");
  return quest_.next(narrow && !apart.empty() ? apart : allowed);
}

void Placement::add(int setting, int score) {
  quest_.update(setting, score - lowest_);
  shown_.push_back(setting);
}

GridEstimate Placement::a() const { return grid_estimate(a_values_, quest_.posterior()); }
GridEstimate Placement::b() const { return grid_estimate(b_values_, quest_.posterior()); }

}  // namespace stats
