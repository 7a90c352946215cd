#pragma once
/// The marginal likelihood of ratings whose locations share a normal effect of the participant, with or
/// without lapses: answers that are guesses.

#include <span>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"

namespace stats {

/// Derivatives of the log-likelihood.
struct MixedGradient {
  std::vector<double> thresholds, location;  ///< derivatives for each threshold, and for each row's location
  double sd = 0;
  double lapse = 0;  ///< derivative for the lapse rate
};

/// Lapses of attention: with probability `rate` a person guesses, and each of the `choices` scores is then
/// equally likely. P(rating) = (1 - rate) P(rating | attentive) + rate / choices.
struct Lapses {
  double rate = 0;  ///< 0 to below 1
  int choices = 1;  ///< number of scores on the scale, at least 1
};

inline constexpr double largest_lapse = 0.5;  ///< upper bound of a lapse rate that is estimated
/// The lapse rate that belongs to `root`, the parameter that a minimiser varies without bounds. The rate is
/// `least` at root 0 and approaches largest_lapse for large roots. `slope` receives its derivative by `root`.
double lapse_rate(double root, double least, double& slope);

/// The term of a rating that may be a guess, from the term of an attentive one: log_p and its derivatives for
/// the location (d1, d2, d3) and the thresholds (up, up1, up2, lo, lo1, lo2). The second derivatives for the
/// thresholds (up_up, lo_lo, up_lo) are not set.
CategoryTerm with_lapses(const CategoryTerm& attentive, const Lapses& lapses);

/// Adaptive Gauss-Hermite quadrature (Pinheiro and Bates 1995, section 2.4) over each participant's effect,
/// about the mode of the integrand and scaled by the curvature of its logarithm there; one node is Laplace's
/// approximation. The gradient is that of the approximation, so it includes the movement of the nodes with
/// the mode.
class MixedLikelihood {
 public:
  /// category in [0, levels), participant in [0, participants) for each row; points >= 1.
  MixedLikelihood(std::span<const int> category, std::span<const int> participant, Link link, int points);

  /// Log-likelihood and its gradient. -infinity if a rating has probability zero, the thresholds do not
  /// ascend or sd is not finite; the gradient is then invalid. Effects are sd u with u ~ N(0, 1), so the
  /// likelihood is the same for sd and -sd. Not thread-safe: each call starts from the modes that the
  /// previous call found. With lapses the integrand need not be log-concave. The quadrature's scale is
  /// then at most 1, the standard deviation of u.
  double evaluate(std::span<const double> thresholds, std::span<const double> location, double sd,
                  MixedGradient& gradient, const Lapses& lapses = {});
  /// Log-likelihood of each participant at the last evaluate() that was finite.
  const std::vector<double>& by_participant() const { return by_participant_; }

 private:
  struct Group {
    std::vector<std::size_t> rows;
    double mode = 0;
  };
  struct Place;  ///< thresholds, locations and sd of one evaluation
  double add_group(Group& group, const Place& place, MixedGradient& gradient);
  bool find_mode(Group& group, const Place& place) const;

  std::vector<int> category_;
  std::vector<Group> groups_;
  std::vector<double> by_participant_;
  Link link_;
  /// sqrt(2) z and log(w exp(z^2) / sqrt(pi)), for the Gauss-Hermite nodes z and their weights w.
  std::vector<double> nodes_, log_weights_;
};

}  // namespace stats
