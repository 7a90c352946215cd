#include "stats/inference/normality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "stats/inference/sample.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

/// Evaluates a polynomial; coefficients in ascending powers.
double polynomial(std::span<const double> coefficients, double x) {
  double sum = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) sum = sum * x + coefficients[i];
  return sum;
}

/// Royston's weights of the upper half of the sample, largest first. Polynomials in 1/sqrt(n) give the
/// outermost one or two, Blom's scores the others.
std::vector<double> weights(std::size_t n) {
  if (n == 3) return {std::numbers::sqrt2 / 2};
  constexpr std::array outermost{0.0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056};
  constexpr std::array second{0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
  const auto size = static_cast<double>(n);
  std::vector<double> scores;
  double squares = 0;
  for (std::size_t i = 1; i <= n / 2; ++i) {
    scores.push_back(-normal_quantile((static_cast<double>(i) - 0.375) / (size + 0.25)));
    squares += 2 * scores.back() * scores.back();
  }
  const double root = std::sqrt(squares), x = 1 / std::sqrt(size);
  std::vector<double> out{scores[0] / root + polynomial(outermost, x)};
  if (n > 5) out.push_back(scores[1] / root + polynomial(second, x));
  double left = 1;
  for (std::size_t i = 0; i < out.size(); ++i) {
    squares -= 2 * scores[i] * scores[i];
    left -= 2 * out[i] * out[i];
  }
  const double norm = std::sqrt(squares / left);
  for (std::size_t i = out.size(); i < scores.size(); ++i) out.push_back(scores[i] / norm);
  return out;
}

double p_value(double one_minus_w, std::size_t n) {
  const auto size = static_cast<double>(n);
  if (n == 3) {
    const double angle = std::asin(std::sqrt(1 - one_minus_w)) - std::numbers::pi / 3;
    return std::clamp(6 / std::numbers::pi * angle, 0.0, 1.0);
  }
  const double y = std::log(one_minus_w);
  if (n <= 11) {
    constexpr std::array bound{-2.273, 0.459};
    constexpr std::array mean{0.5440, -0.39978, 0.025054, -6.714e-4};
    constexpr std::array log_sd{1.3822, -0.77857, 0.062767, -0.0020322};
    const double gap = polynomial(bound, size) - y;
    // The approximation is undefined for a W this small.
    if (gap <= 0) return 0;
    return normal_probability((polynomial(mean, size) + std::log(gap)) / std::exp(polynomial(log_sd, size)));
  }
  constexpr std::array mean{-1.5861, -0.31082, -0.083751, 0.0038915};
  constexpr std::array log_sd{-0.4803, -0.082676, 0.0030302};
  const double x = std::log(size);
  return normal_probability((polynomial(mean, x) - y) / std::exp(polynomial(log_sd, x)));
}

}  // namespace

Result<ShapiroWilk> shapiro_wilk(std::span<const double> values) {
  const auto sample = present(values);
  if (!sample) return Refusal{sample.reason()};
  const auto n = sample->values.size();
  if (n < 3) return Refusal{"fewer than 3 values"};
  if (n > 5000) return Refusal{"more than 5000 values, beyond the approximation"};
  auto ordered = scaled(sample->values, common_exponent(sample->values));
  std::sort(ordered.begin(), ordered.end());
  if (ordered.front() == ordered.back()) return Refusal{"all values are equal"};

  const auto a = weights(n);
  Wide sum, norm;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += Wide(a[i]) * (ordered[n - 1 - i] - ordered[i]);
    norm += Wide(2) * exact_product(a[i], a[i]);
  }
  const Wide total = norm * moments(ordered).squares;
  const double one_minus_w = std::max(((total - sum * sum) / total).value(), 1e-300);
  return ShapiroWilk{1 - one_minus_w, p_value(one_minus_w, n), n, sample->n_missing};
}

}  // namespace stats
