#pragma once
/// Least squares of a surface that is a sum of fixed terms, whose coefficients depend on fewer parameters.
/// The sums over the ratings are computed once; the cost of each fit then does not depend on the number of
/// ratings.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace stats {

/// Solves A x = b for a row-major A of a size known at compile time, by Cholesky factorisation. Empty unless
/// A is positive definite beyond rounding.
template <std::size_t N>
std::optional<std::array<double, N>> solve_positive(std::array<double, N * N> a, std::array<double, N> b) {
  for (std::size_t c = 0; c < N; ++c) {
    const double whole = a[c * N + c];
    double pivot = whole;
    for (std::size_t k = 0; k < c; ++k) pivot -= a[c * N + k] * a[c * N + k];
    if (!(pivot > 1e-12 * whole) || !std::isfinite(pivot)) return std::nullopt;
    a[c * N + c] = std::sqrt(pivot);
    for (std::size_t r = c + 1; r < N; ++r) {
      for (std::size_t k = 0; k < c; ++k) a[r * N + c] -= a[r * N + k] * a[c * N + k];
      a[r * N + c] /= a[c * N + c];
    }
  }
  for (std::size_t r = 0; r < N; ++r) {
    for (std::size_t k = 0; k < r; ++k) b[r] -= a[r * N + k] * b[k];
    b[r] /= a[r * N + r];
  }
  for (std::size_t r = N; r-- > 0;) {
    for (std::size_t k = r + 1; k < N; ++k) b[r] -= a[k * N + r] * b[k];
    b[r] /= a[r * N + r];
  }
  return b;
}

template <std::size_t Terms>
struct TermSums {
  std::array<double, Terms * Terms> gram{};  ///< sums of products of two terms, row-major
  std::array<double, Terms> moment{};        ///< sums of products of a term and the value
  double squares = 0;                        ///< sum of squares of the values
  double n = 0;

  /// Adds one rating: its terms and its value.
  void add(const std::array<double, Terms>& row, double y) {
    for (std::size_t i = 0; i < Terms; ++i) {
      moment[i] += row[i] * y;
      for (std::size_t j = 0; j < Terms; ++j) gram[i * Terms + j] += row[i] * row[j];
    }
    squares += y * y;
    n += 1;
  }

  /// Adds other sums, counted `weight` times.
  void add(const TermSums& other, double weight) {
    for (std::size_t i = 0; i < gram.size(); ++i) gram[i] += weight * other.gram[i];
    for (std::size_t i = 0; i < Terms; ++i) moment[i] += weight * other.moment[i];
    squares += weight * other.squares;
    n += weight * other.n;
  }

  /// Sum of squared residuals of a surface with these coefficients.
  double residuals(const std::array<double, Terms>& c) const {
    double value = squares;
    for (std::size_t i = 0; i < Terms; ++i) {
      double row = -2 * moment[i];
      for (std::size_t j = 0; j < Terms; ++j) row += gram[i * Terms + j] * c[j];
      value += c[i] * row;
    }
    return value;
  }
};

/// A local minimum by Marquardt's (1963) method: damped Gauss-Newton steps until they vanish or none improves
/// the fit, at most 200. The type Place provides `terms`, `parameters`, coefficients(), jacobian() (one row
/// for each parameter) and moved(step).
template <class Place>
Place descend(const TermSums<Place::terms>& sums, Place at) {
  constexpr std::size_t T = Place::terms, P = Place::parameters;
  double value = sums.residuals(at.coefficients()), damping = 1e-4;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const auto c = at.coefficients();
    const auto J = at.jacobian();
    std::array<double, T> slope{};  // half the gradient with respect to the coefficients
    for (std::size_t i = 0; i < T; ++i) {
      slope[i] = -sums.moment[i];
      for (std::size_t j = 0; j < T; ++j) slope[i] += sums.gram[i * T + j] * c[j];
    }
    std::array<double, P * P> normal{};
    std::array<double, P> down{};
    for (std::size_t r = 0; r < P; ++r) {
      std::array<double, T> gj{};
      for (std::size_t i = 0; i < T; ++i) {
        down[r] -= J[r][i] * slope[i];
        for (std::size_t j = 0; j < T; ++j) gj[i] += sums.gram[i * T + j] * J[r][j];
      }
      for (std::size_t s = 0; s < P; ++s) {
        for (std::size_t i = 0; i < T; ++i) normal[r * P + s] += gj[i] * J[s][i];
      }
    }
    bool moved = false;
    for (; damping < 1e12 && !moved; damping *= 10) {
      auto damped = normal;
      for (std::size_t r = 0; r < P; ++r) damped[r * (P + 1)] *= 1 + damping;
      const auto step = solve_positive<P>(damped, down);
      if (!step) continue;
      const Place next = at.moved(*step);
      const double there = sums.residuals(next.coefficients());
      double length = 0;
      for (const double s : *step) length = std::max(length, std::abs(s));
      if (length < 1e-10) return there < value ? next : at;
      if (!(there < value)) continue;
      at = next;
      value = there;
      damping = std::max(damping / 100, 1e-12);
      moved = true;
    }
    if (!moved) return at;
  }
  return at;
}

}  // namespace stats
