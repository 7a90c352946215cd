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
  /// `columns` (of X) and y have one length; `participant` counts from 0, `thing` is any number.
  RestrictedLikelihood(std::span<const std::vector<double>> columns, std::span<const double> y,
                       std::span<const int> participant, std::span<const int> thing);

  /// The likelihood's parts at one lambda; V is the covariance of y over sigma^2.
  struct At {
    std::vector<double> beta;       ///< generalised least squares
    std::vector<double> inverse;    ///< (X' V^-1 X)^-1, row-major
    double residual = 0;            ///< r' V^-1 r
    double log_determinants = 0;    ///< log |V| + log |X' V^-1 X|
    std::array<double, 2> slope{};  ///< derivatives of log_determinants with respect to each lambda
    std::array<double, 2> residual_slope{};
    std::array<std::vector<double>, 2> inverse_slope;  ///< derivatives of `inverse`
  };
  /// Empty if X' V^-1 X is singular or the fit leaves no residual.
  std::optional<At> at(std::array<double, 2> lambda) const;

  /// Rows minus columns.
  int freedom() const { return n_ - static_cast<int>(q_); }
  int participants() const { return static_cast<int>(people_.size()); }

 private:
  /// Rows of one participant about one thing: their number, and the sums of the columns and y over them.
  struct Group {
    double n = 0;
    std::vector<double> sums;
  };
  /// Sums over people from which at() is computed; matrices are over columns and y together.
  struct Sums {
    std::vector<double> gram;  ///< (X y)' V^-1 (X y)
    double log_det_v = 0;
    std::array<double, 2> trace{};              ///< of V^-1 Z Z'
    std::array<std::vector<double>, 2> spread;  ///< (X y)' V^-1 Z Z' V^-1 (X y)
  };
  void add_person(const std::vector<Group>& groups, std::array<double, 2> theta, Sums& sums) const;

  int n_ = 0;
  std::size_t q_ = 0;
  std::vector<double> gram_;  ///< (X y)'(X y)
  std::vector<std::vector<Group>> people_;
};

}  // namespace stats
