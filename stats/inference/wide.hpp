#pragma once
/// Numbers of twice the precision of double, for sums that must not depend on the data's offset.

#include <cmath>

namespace stats {

/// The unevaluated sum high + low, |low| <= ulp(high)/2: about 32 digits (Dekker 1971; Hida, Li and Bailey
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

/// Square root of a >= 0: one Newton step from double's.
inline Wide sqrt(Wide a) {
  if (!(a.high > 0)) return 0;
  const double root = std::sqrt(a.high);
  return exact_sum(root, (a - exact_product(root, root)).high / (2 * root));
}

}  // namespace stats
