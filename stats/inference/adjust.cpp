#include "stats/inference/adjust.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace stats {

namespace {

using Values = std::vector<double>;

/// Multiplies the ith smallest p (i = 1, 2 ...) by factor(i); capped at 1.
Values scaled(const Values& sorted, const std::function<double(double)>& factor) {
  Values out(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i)
    out[i] = std::min(1.0, factor(static_cast<double>(i + 1)) * sorted[i]);
  return out;
}

/// Raises each value to the largest value before it, if that is larger.
Values step_down(Values values) {
  for (std::size_t i = 1; i < values.size(); ++i) values[i] = std::max(values[i], values[i - 1]);
  return values;
}

/// Lowers each value to the smallest value after it, if that is smaller.
Values step_up(Values values) {
  for (std::size_t i = values.size() - 1; i-- > 0;) values[i] = std::min(values[i], values[i + 1]);
  return values;
}

Values adjusted_in_order(const Values& sorted, Adjustment method) {
  const auto n = static_cast<double>(sorted.size());
  switch (method) {
    case Adjustment::None:
      return sorted;
    case Adjustment::Bonferroni:
      return scaled(sorted, [n](double) { return n; });
    case Adjustment::Holm:
      return step_down(scaled(sorted, [n](double i) { return n - i + 1; }));
    case Adjustment::BenjaminiHochberg:
      return step_up(scaled(sorted, [n](double i) { return n / i; }));
  }
  throw std::invalid_argument("adjust: the method is unknown; give one of Adjustment");
}

}  // namespace

Result<AdjustedP> adjust(std::span<const double> p, Adjustment method, std::size_t family) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (std::isnan(p[i])) continue;
    if (!(p[i] >= 0 && p[i] <= 1)) return Refusal{"a p-value outside [0, 1]"};
    order.push_back(i);
  }
  if (order.empty()) return Refusal{"no p-value in the family"};
  if (family != 0 && family < order.size())
    return Refusal{"a family of " + std::to_string(family) + " is smaller than its " +
                   std::to_string(order.size()) + " p-values"};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });

  AdjustedP out{.p = Values(p.size(), std::numeric_limits<double>::quiet_NaN()),
                .family = std::max(family, order.size()),
                .missing = p.size() - order.size()};
  Values sorted(out.family, 1.0);
  for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = p[order[i]];
  const Values adjusted = adjusted_in_order(sorted, method);
  for (std::size_t i = 0; i < order.size(); ++i) out.p[order[i]] = adjusted[i];
  return out;
}

const char* stars(double p) { return p < 0.001 ? "***" : p < 0.01 ? "**" : p < 0.05 ? "*" : ""; }

}  // namespace stats
