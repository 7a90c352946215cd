#include "stats/ordinal/level_thresholds.hpp"

#include <cmath>

#include "stats/ordinal/cumulative_link.hpp"
#include "stats/quantiles.hpp"

namespace stats {

LevelThresholds level_thresholds(std::span<const double> log_gaps, double sd, std::span<const double> levels,
                                 double level) {
  LevelThresholds out;
  std::vector<double> t{0};
  for (const double gap : log_gaps) t.push_back(t.back() + std::exp(gap));
  const double s = std::sqrt(1 + sd * sd);
  const auto expected = [&](double c) {
    double e = levels[0];
    for (std::size_t j = 0; j < t.size(); ++j)
      e += (levels[j + 1] - levels[j]) * normal_probability(-(c + t[j]) / s);
    return e;
  };
  double low = -t.back() - 40 * s, high = 40 * s;
  for (int i = 0; i < 200 && high - low > 1e-15 * (1 + std::abs(low)); ++i) {
    const double middle = (low + high) / 2;
    (expected(middle) > level ? low : high) = middle;
  }
  const double c = (low + high) / 2;
  double stretch = 0;
  for (std::size_t j = 0; j < t.size(); ++j) {
    out.theta.push_back(c + t[j]);
    out.weight.push_back((levels[j + 1] - levels[j]) * link_value(Link::Probit, out.theta[j] / s).f / s);
    out.total += out.weight[j];
    stretch += out.weight[j] * out.theta[j] / s;
  }
  out.by_sd = stretch / out.total * sd / s;
  return out;
}

double LevelThresholds::by_gaps(std::span<const double> log_gaps, std::span<const double> thresholds,
                                std::span<double> out) const {
  // `above`: derivative for a shift of the thresholds above gap j. c then moves by weight_above / total.
  double shift = 0, above = 0, weight_above = 0;
  for (const double g : thresholds) shift += g;
  for (std::size_t j = log_gaps.size(); j-- > 0;) {
    above += thresholds[j + 1];
    weight_above += weight[j + 1];
    out[j] = std::exp(log_gaps[j]) * (above - shift * weight_above / total);
  }
  return shift;
}

}  // namespace stats
