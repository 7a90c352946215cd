#pragma once
/// Symmetric positive definite systems of a few unknowns.

#include <optional>
#include <span>
#include <vector>

namespace stats {

/// L L^T = A (Golub and Van Loan 2013, algorithm 4.2.1).
class Cholesky {
 public:
  /// `matrix` is n x n, row-major; its lower triangle is read. Empty unless every pivot exceeds
  /// `least_pivot` times its diagonal element: what is left of a column after the others is then more than
  /// rounding.
  static std::optional<Cholesky> of(std::span<const double> matrix, double least_pivot = 1e-13);

  /// x with A x = b.
  std::vector<double> solve(std::span<const double> b) const;
  /// A^-1, row-major.
  std::vector<double> inverse() const;
  /// log |A|.
  double log_determinant() const;

 private:
  std::size_t n_ = 0;
  std::vector<double> lower_;
};

}  // namespace stats
