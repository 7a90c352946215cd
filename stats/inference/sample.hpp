#pragma once
/// Samples without missing values, and their moments to twice double's precision. The tests in this folder
/// use them.

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// A number of twice the precision of double, for sums that must not depend on the data's offset: the
/// unevaluated sum high + low, |low| <= ulp(high)/2: about 32 digits (Dekker 1971; Hida, Li and Bailey
/// 2001). The range is double's; products lose their low part below 1e-292, so scale the data first.
struct Wide {
  double high = 0, low = 0;

  constexpr Wide() = default;
  constexpr Wide(double value) : high(value) {}
  constexpr Wide(double high_part, double low_part) : high(high_part), low(low_part) {}
  double value() const { return high + low; }
};

/// a + b without error (Knuth's TwoSum).
inline Wide exact_sum(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}

/// a * b without error.
inline Wide exact_product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

inline Wide operator-(Wide a) { return {-a.high, -a.low}; }

inline Wide operator+(Wide a, Wide b) {
  const Wide s = exact_sum(a.high, b.high), t = exact_sum(a.low, b.low);
  const Wide u = exact_sum(s.high, s.low + t.high);
  return exact_sum(u.high, u.low + t.low);
}
inline Wide operator-(Wide a, Wide b) { return a + -b; }

inline Wide operator*(Wide a, Wide b) {
  const Wide p = exact_product(a.high, b.high);
  return exact_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

inline Wide operator/(Wide a, Wide b) {
  const double q1 = a.high / b.high;
  const Wide r1 = a - b * q1;
  const double q2 = r1.high / b.high;
  const Wide r2 = r1 - b * q2;
  return exact_sum(q1, q2) + r2.high / b.high;
}

inline Wide& operator+=(Wide& a, Wide b) { return a = a + b; }
inline Wide& operator-=(Wide& a, Wide b) { return a = a - b; }
inline bool operator<(Wide a, Wide b) { return a.high < b.high || (a.high == b.high && a.low < b.low); }
inline bool operator==(Wide a, Wide b) { return a.high == b.high && a.low == b.low; }

inline Wide abs(Wide a) { return a < Wide(0) ? -a : a; }

/// Square root of a >= 0: one Newton step from the square root in double.
inline Wide sqrt(Wide a) {
  if (!(a.high > 0)) return 0;
  const double root = std::sqrt(a.high);
  return exact_sum(root, (a - exact_product(root, root)).high / (2 * root));
}

/// The values that are not missing, all finite, in their order.
struct Sample {
  std::vector<double> values;
  std::size_t n_missing = 0;
};

/// Drops and counts the missing values (NaN). Refused: an infinite value.
Result<Sample> present(std::span<const double> values);

struct PairedSample {
  std::vector<double> x, y;
  std::size_t n_missing = 0;  ///< pairs left out because a value is missing
};

/// Drops and counts the pairs in which x or y is missing (NaN). std::invalid_argument if the lengths differ.
/// Refused: an infinite value in a complete pair.
Result<PairedSample> present_pairs(std::span<const double> x, std::span<const double> y);

/// The exponent for which the largest magnitude times 2^-exponent lies in [0.5, 1); 0 if all are zero.
int common_exponent(std::span<const double> a, std::span<const double> b = {});

/// value * 2^-exponent, exact.
std::vector<Wide> scaled(std::span<const double> values, int exponent);

/// Mean, and sum of squared deviations from it.
struct Moments {
  std::size_t n = 0;
  Wide mean, squares;
  /// Sample variance, with divisor n - 1; 0 for one value.
  double variance() const { return n > 1 ? (squares / static_cast<double>(n - 1)).value() : 0; }
};

Moments moments(std::span<const Wide> values);

/// Sum of (x - mean x)(y - mean y).
Wide cross_squares(std::span<const Wide> x, const Moments& of_x, std::span<const Wide> y,
                   const Moments& of_y);

/// A table of participants by conditions, without participants who lack a value.
struct CompleteRows {
  std::vector<double> values{};  ///< n rows of k
  int n = 0, n_missing = 0, k = 0;
  std::string refusal{};  ///< fewer than two conditions or complete rows, or an infinite value; else empty

  std::span<const double> row(int i) const {
    return std::span(values).subspan(static_cast<std::size_t>(i) * static_cast<std::size_t>(k),
                                     static_cast<std::size_t>(k));
  }
};

/// Drops and counts the rows with a NaN. std::invalid_argument if the values do not fill whole rows or k < 1.
CompleteRows complete_rows(std::span<const double> rows, int k);

}  // namespace stats
