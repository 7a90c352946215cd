#include "stats/inference/sample.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stats {

namespace {
const Refusal infinite_value{"a value is infinite"};
}

Result<Sample> present(std::span<const double> values) {
  Sample out;
  for (const double v : values) {
    if (std::isnan(v)) {
      ++out.n_missing;
    } else if (std::isinf(v)) {
      return infinite_value;
    } else {
      out.values.push_back(v);
    }
  }
  return out;
}

Result<PairedSample> present_pairs(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size())
    throw std::invalid_argument("paired values: x and y differ in length; give one y for each x");
  PairedSample out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]) || std::isnan(y[i])) {
      ++out.n_missing;
    } else if (std::isinf(x[i]) || std::isinf(y[i])) {
      return infinite_value;
    } else {
      out.x.push_back(x[i]);
      out.y.push_back(y[i]);
    }
  }
  return out;
}

int common_exponent(std::span<const double> a, std::span<const double> b) {
  double largest = 0;
  for (const double v : a) largest = std::max(largest, std::abs(v));
  for (const double v : b) largest = std::max(largest, std::abs(v));
  int exponent = 0;
  std::frexp(largest, &exponent);
  return exponent;
}

std::vector<Wide> scaled(std::span<const double> values, int exponent) {
  std::vector<Wide> out;
  out.reserve(values.size());
  for (const double v : values) out.emplace_back(std::ldexp(v, -exponent));
  return out;
}

Moments moments(std::span<const Wide> values) {
  Moments out;
  out.n = values.size();
  if (out.n == 0) return out;
  // Relative to the first value, so that equal values give squares of exactly 0.
  Wide excess;
  for (const auto& v : values) excess += v - values[0];
  excess = excess / static_cast<double>(out.n);
  for (const auto& v : values) {
    const Wide deviation = v - values[0] - excess;
    out.squares += deviation * deviation;
  }
  out.mean = values[0] + excess;
  return out;
}

Wide cross_squares(std::span<const Wide> x, const Moments& of_x, std::span<const Wide> y,
                   const Moments& of_y) {
  Wide sum;
  for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - of_x.mean) * (y[i] - of_y.mean);
  return sum;
}

CompleteRows complete_rows(std::span<const double> rows, int k) {
  if (k < 1 || rows.size() % static_cast<std::size_t>(k) != 0)
    throw std::invalid_argument(
        "table of participants: the values do not fill whole rows; give k values for each participant, k at "
        "least 1");
  CompleteRows out{.k = k};
  const auto width = static_cast<std::size_t>(k);
  for (std::size_t first = 0; first < rows.size(); first += width) {
    const auto row = rows.subspan(first, width);
    if (std::any_of(row.begin(), row.end(), [](double v) { return std::isnan(v); })) {
      ++out.n_missing;
      continue;
    }
    if (std::any_of(row.begin(), row.end(), [](double v) { return std::isinf(v); }))
      out.refusal = "an infinite value";
    out.values.insert(out.values.end(), row.begin(), row.end());
    ++out.n;
  }
  if (k < 2)
    out.refusal = "fewer than two conditions";
  else if (out.n < 2)
    out.refusal = "fewer than two participants with all conditions";
  return out;
}

}  // namespace stats
