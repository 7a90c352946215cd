#pragma once
/// Cholesky factorisation of small symmetric positive definite matrices.

#include <optional>
#include <span>
#include <vector>

namespace stats {

/// Factorisation L L^T = A (Golub and Van Loan 2013, algorithm 4.2.1).
class Cholesky {
 public:
  /// `matrix` is n x n, row-major; only its lower triangle is read. Returns nothing if a pivot is not finite
  /// or is at most `least_pivot` times the diagonal element of `matrix` in its row: up to rounding the matrix
  /// is then not positive definite. std::invalid_argument if the matrix is not square.
  static std::optional<Cholesky> of(std::span<const double> matrix, double least_pivot = 1e-13);

  /// Solves A x = b.
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
