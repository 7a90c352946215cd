#pragma once
/// The restricted likelihood of a linear model with nested random effects, y = X beta + u_p + v_pt + e, for
/// people p and the things t that they judge. Both effects and e are normal, with the standard deviations
/// lambda_0 sigma, lambda_1 sigma and sigma (Bates, Maechler, Bolker and Walker 2015, J. Stat. Softw. 67(1)).

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "stats/cholesky.hpp"

namespace stats {

class RestrictedLikelihood {
 public:
  /// The columns of X, y, `participant` and `thing` have one length. Equal numbers in `participant` are one
  /// participant, equal numbers in `thing` one thing.
  RestrictedLikelihood(std::span<const std::vector<double>> columns, std::span<const double> y,
                       std::span<const int> participant, std::span<const int> thing);

  /// The parts of the likelihood at one pair of lambdas, which are the standard deviations of the two random
  /// effects, each divided by sigma. V is the covariance matrix of y divided by sigma^2, and r is y - X beta.
  struct At {
    std::vector<double> beta;                ///< the estimate by generalised least squares
    std::vector<double> inverse;             ///< (X' V^-1 X)^-1, row-major
    double residual = 0;                     ///< r' V^-1 r
    double log_determinants = 0;             ///< log |V| + log |X' V^-1 X|
    std::array<double, 2> slope{};           ///< derivatives of log_determinants with respect to each lambda
    std::array<double, 2> residual_slope{};  ///< derivatives of `residual` with respect to each lambda
    std::array<std::vector<double>, 2> inverse_slope;  ///< derivatives of `inverse` with respect to each
                                                       ///< lambda
  };
  /// Empty if X' V^-1 X is singular or the fit leaves no residual.
  std::optional<At> at(std::array<double, 2> lambda) const;

  /// Residual degrees of freedom: rows minus columns.
  int freedom() const { return n_ - static_cast<int>(q_); }
  int participants() const { return static_cast<int>(people_.size()); }

 private:
  /// The rows of one participant about one thing: their number n, and the sums of each column and of y over
  /// these rows.
  struct Group {
    double n = 0;
    std::vector<double> sums;
  };
  /// Sums over people from which at() is computed. (X y) is the matrix of the columns and y, and V is the
  /// covariance matrix of y divided by the residual variance. Z assigns the rows to participants for index 0,
  /// and to participants with things for index 1.
  struct Sums {
    std::vector<double> gram;  ///< (X y)' V^-1 (X y)
    double log_det_v = 0;
    std::array<double, 2> trace{};              ///< trace of V^-1 Z Z'
    std::array<std::vector<double>, 2> spread;  ///< (X y)' V^-1 Z Z' V^-1 (X y)
  };
  void add_person(const std::vector<Group>& groups, std::array<double, 2> theta, Sums& sums) const;

  int n_ = 0;
  std::size_t q_ = 0;
  std::vector<double> gram_;  ///< (X y)'(X y)
  std::vector<std::vector<Group>> people_;
};

}  // namespace stats
