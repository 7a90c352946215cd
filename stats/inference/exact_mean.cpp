#include "stats/inference/exact_mean.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

namespace stats {

namespace {

constexpr double largest_whole = 0x1p53;  ///< up to here a double represents every whole number exactly

bool has_both(const ExactMean& x, const ExactMean& y) { return !std::isnan(x.sum) && !std::isnan(y.sum); }

double largest_mean(std::span<const ExactMean> x, std::span<const ExactMean> y) {
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i].count < 1 || y[i].count < 1)
      throw std::invalid_argument(
          "exact_differences: a mean has a count below 1; give the number of values in its sum");
    if (has_both(x[i], y[i])) largest = std::max({largest, std::abs(x[i].value()), std::abs(y[i].value())});
  }
  return largest;
}

}  // namespace

std::vector<double> ExactDifferences::values() const {
  std::vector<double> out;
  for (const double numerator : numerators) out.push_back(numerator / denominator);
  return out;
}

Result<ExactDifferences> exact_differences(std::span<const ExactMean> x, std::span<const ExactMean> y) {
  if (x.size() != y.size())
    throw std::invalid_argument("exact_differences: x and y differ in length; give one y for each x");
  const auto largest = largest_mean(x, y);
  if (std::isinf(largest)) return Refusal{"a value is infinite"};
  ExactDifferences out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!has_both(x[i], y[i])) continue;
    for (const int count : {x[i].count, y[i].count}) {
      const auto common = std::gcd(static_cast<std::int64_t>(out.denominator), std::int64_t{count});
      out.denominator *= static_cast<double>(count / common);
      if (out.denominator * std::max(1.0, 2 * largest) > largest_whole)
        return Refusal{"the numbers of answers have no common denominator small enough to rank by"};
    }
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!has_both(x[i], y[i])) {
      ++out.n_missing;
      continue;
    }
    out.numerators.push_back(x[i].sum * (out.denominator / x[i].count) -
                             y[i].sum * (out.denominator / y[i].count));
  }
  return out;
}

}  // namespace stats
