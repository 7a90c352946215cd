#include "libstudy/light/light_edges.hpp"

#include <algorithm>
#include <cmath>

#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr double least_separation = 6;  // levels apart, in the noise about them: halves of one bell are 2.3
constexpr std::size_t most_for_levels = 2'000'000;
constexpr double switch_share = 0.65;

double median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

float quantile_of(std::vector<float>& values, double p) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

LightLevels find_levels(std::span<const float> samples, const std::string& place, const std::string& what,
                        double outliers) {
  std::vector<float> some;
  const std::size_t step = samples.size() / most_for_levels + 1;
  for (std::size_t i = 0; i < samples.size(); i += step) some.push_back(samples[i]);
  double low = some.size() < 2 ? 0 : quantile_of(some, outliers);
  double high = some.size() < 2 ? 0 : quantile_of(some, 1 - outliers);
  std::vector<float> dark, bright;
  for (int round = 0; round < 20 && high > low; ++round) {
    const double middle = 0.5 * (low + high);
    dark.clear();
    bright.clear();
    for (const float value : some) (value < middle ? dark : bright).push_back(value);
    if (dark.empty() || bright.empty()) break;
    const double next_low = median_of(dark), next_high = median_of(bright);
    const bool settled = next_low == low && next_high == high;
    low = next_low;
    high = next_high;
    if (settled) break;
  }
  std::vector<float> away;
  for (const float value : dark) away.push_back(static_cast<float>(std::abs(value - low)));
  for (const float value : bright) away.push_back(static_cast<float>(std::abs(value - high)));
  const double noise = away.empty() ? 0 : 1.4826 * median_of(away);
  if (dark.empty() || bright.empty() || !(high - low > least_separation * noise))
    throw base::Error(
        place, what + " does not change between two levels",
        "put the sensor on the patch of a run with --light-patch and shield it from other light; "
        "if another column holds the level, name it with --columns");
  return {low, high, noise};
}

std::vector<LightEdge> find_edges(const SensorLog& log, std::span<const float> samples,
                                  const LightLevels& levels, double hold_s) {
  const double span = levels.high - levels.low, middle = levels.low + 0.5 * span;
  const double up = levels.low + switch_share * span, down = levels.high - switch_share * span;
  std::vector<LightEdge> edges;
  if (samples.empty()) return edges;
  bool bright = samples.front() > middle;
  double crossing_s = log.time_s.front();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double before = samples[i - 1], now = samples[i];
    const bool rises = before <= middle && now > middle, falls = before >= middle && now < middle;
    if ((!bright && rises) || (bright && falls)) {
      const double step_s = log.time_s[i] - log.time_s[i - 1];
      crossing_s =
          log.events ? log.time_s[i] : log.time_s[i - 1] + step_s * (middle - before) / (now - before);
    }
    if (bright ? now < down : now > up) {
      bright = !bright;
      edges.push_back({crossing_s, bright});
    }
  }
  if (hold_s <= 0) return edges;
  std::vector<LightEdge> bridged;
  for (const LightEdge& edge : edges) {
    const bool bridges = edge.rise && !bridged.empty() && edge.time_s - bridged.back().time_s < hold_s;
    if (bridges)
      bridged.pop_back();
    else
      bridged.push_back(edge);
  }
  return bridged;
}

}  // namespace study
