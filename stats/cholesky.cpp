#include "stats/cholesky.hpp"

#include <cmath>
#include <stdexcept>

namespace stats {

std::optional<Cholesky> Cholesky::of(std::span<const double> matrix, double least_pivot) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  if (n * n != matrix.size())
    throw std::invalid_argument("Cholesky::of: the matrix is not square; give n x n elements");
  Cholesky out;
  out.n_ = n;
  out.lower_.assign(matrix.begin(), matrix.end());
  auto& l = out.lower_;
  for (std::size_t column = 0; column < n; ++column) {
    const double whole = l[column * n + column];
    double pivot = whole;
    for (std::size_t k = 0; k < column; ++k) pivot -= l[column * n + k] * l[column * n + k];
    if (!(pivot > least_pivot * whole) || !std::isfinite(pivot)) return std::nullopt;
    const double root = std::sqrt(pivot);
    l[column * n + column] = root;
    for (std::size_t row = column + 1; row < n; ++row) {
      double sum = l[row * n + column];
      for (std::size_t k = 0; k < column; ++k) sum -= l[row * n + k] * l[column * n + k];
      l[row * n + column] = sum / root;
    }
  }
  return out;
}

std::vector<double> Cholesky::solve(std::span<const double> b) const {
  if (b.size() != n_)
    throw std::invalid_argument(
        "Cholesky::solve: b does not fit the matrix; give one element for each of its rows");
  std::vector<double> x(b.begin(), b.end());
  for (std::size_t row = 0; row < n_; ++row) {
    for (std::size_t k = 0; k < row; ++k) x[row] -= lower_[row * n_ + k] * x[k];
    x[row] /= lower_[row * n_ + row];
  }
  for (std::size_t row = n_; row-- > 0;) {
    for (std::size_t k = row + 1; k < n_; ++k) x[row] -= lower_[k * n_ + row] * x[k];
    x[row] /= lower_[row * n_ + row];
  }
  return x;
}

std::vector<double> Cholesky::inverse() const {
  std::vector<double> out(n_ * n_), unit(n_);
  for (std::size_t column = 0; column < n_; ++column) {
    unit.assign(n_, 0.0);
    unit[column] = 1;
    const auto x = solve(unit);
    for (std::size_t row = 0; row < n_; ++row) out[row * n_ + column] = x[row];
  }
  return out;
}

double Cholesky::log_determinant() const {
  double sum = 0;
  for (std::size_t i = 0; i < n_; ++i) sum += 2 * std::log(lower_[i * n_ + i]);
  return sum;
}

}  // namespace stats
