#pragma once
/// Solves positive definite systems of a size known at compile time; thousands of fits use it.

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace stats {

/// Solves A x = b for a row-major A. Empty unless A is positive definite beyond rounding.
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

}  // namespace stats
