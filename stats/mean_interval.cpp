#include "stats/mean_interval.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "stats/quantiles.hpp"

namespace stats {

MeanInterval mean_interval(std::span<const double> values, double confidence) {
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument(
        "mean_interval: the confidence is not between 0 and 1; give one such as 0.95");
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
    throw std::invalid_argument("mean_interval: a value is not finite; leave such values out");
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  MeanInterval out{unknown, unknown, unknown, values.size()};
  if (values.empty()) return out;
  const auto n = static_cast<double>(values.size());
  out.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  if (values.size() < 2) return out;
  double squares = 0;
  for (const double v : values) squares += (v - out.mean) * (v - out.mean);
  const double error = std::sqrt(squares / (n - 1) / n);
  const double reach = student_quantile(0.5 + confidence / 2, n - 1) * error;
  out.low = out.mean - reach;
  out.high = out.mean + reach;
  return out;
}

std::vector<double> group_means(std::span<const double> values, std::size_t size) {
  if (size == 0 || values.size() % size != 0)
    throw std::invalid_argument(
        "group_means: the values do not fill whole groups; give a multiple of `size` values, `size` at least "
        "1");
  std::vector<double> out;
  for (std::size_t first = 0; first < values.size(); first += size) {
    double sum = 0;
    std::size_t count = 0;
    for (const double v : values.subspan(first, size)) {
      if (!std::isfinite(v)) continue;
      sum += v;
      ++count;
    }
    if (count > 0) out.push_back(sum / static_cast<double>(count));
  }
  return out;
}

std::vector<double> paired_group_means(std::span<const double> a, std::span<const double> b,
                                       std::size_t size) {
  if (a.size() != b.size())
    throw std::invalid_argument("paired_group_means: a and b differ in length; give one b for each a");
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(a[i] - b[i]);
  return group_means(differences, size);
}

}  // namespace stats
