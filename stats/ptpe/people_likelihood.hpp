#pragma once
/// The marginal likelihood of ratings by people who each have a contour mu = a_p exp(b_p delta) of their own
/// (people_fit.hpp has the model): a two-dimensional integral for each person.

#include <array>
#include <span>
#include <vector>

#include "stats/ordinal/mixed_likelihood.hpp"

namespace stats {

/// Ratings as categories. All columns have one length.
struct PeopleRows {
  std::vector<double> x, d;  ///< log of the mean frame rate mu, and delta / delta_unit, each less its mean
  std::vector<double> position;  ///< place in the session, from -0.5 to 0.5; all 0: not known
  std::vector<int> category, person;
  std::vector<double> levels;  ///< the scores that occur, ascending
  int choices = 7;             ///< number of scores on the scale
  int people = 0;
  double x_mean = 0, delta_mean = 0;

  std::size_t n() const { return x.size(); }
  std::size_t gaps() const { return levels.size() - 2; }
};

/// Places of the parameters that follow the log gaps of the thresholds. LogSdA and LogSdB are logs of the SDs
/// over people of alpha = log a_p and beta = b_p delta_unit at the mean delta; ArtanhR is the inverse
/// hyperbolic tangent of their correlation; LapseRoot is the parameter of lapse_rate().
struct PeopleAt {
  enum : std::size_t { Alpha, Beta, K, M, Q, Drift, LogSdA, LogSdB, ArtanhR, LapseRoot, Count };
};

/// Mean and covariance of one person's (alpha, beta), given this person's answers and the parameters.
struct PersonMoments {
  std::array<double, 2> mean{};
  double var_alpha = 0, cov = 0, var_beta = 0;
};

/// Adaptive Gauss-Hermite quadrature over the two effects of each person, with `points` nodes in each
/// direction about the mode of the integrand; one node is Laplace's approximation.
class PeopleLikelihood {
 public:
  /// Refers to `rows`, which must live as long. The level lies between the lowest and the highest score.
  /// points >= 1 (std::invalid_argument).
  PeopleLikelihood(const PeopleRows& rows, double level, double least_lapse, int points);

  std::size_t size() const { return rows_.gaps() + PeopleAt::Count; }

  /// Log-likelihood and its gradient for all parameters; -infinity outside the domain. follow(true), the
  /// default: the nodes are placed anew at each call, and the gradient leaves their movement out, which is
  /// exact up to the error of the quadrature. follow(false): the nodes stay, and the gradient is exact.
  double evaluate(std::span<const double> at, std::span<double> gradient);
  void follow(bool on) { follow_ = on; }

  /// Moments of each person's (alpha, beta) at the last evaluate() that was finite.
  const std::vector<PersonMoments>& moments() const { return moments_; }
  /// Log-likelihood of one person's answers for (alpha, beta) of the person's own, with its derivatives for
  /// them; the other parameters are `at`. -infinity outside the domain.
  double of_person(int person, std::span<const double> at, std::array<double, 2> own,
                   std::array<double, 2>& slope) const;

 private:
  struct Place;
  struct Person {
    std::vector<std::size_t> rows;
    std::array<double, 2> mode{};
    std::array<double, 3> spread{1, 0,
                                 1};  ///< lower triangle of the Cholesky factor of the nodes' covariance
  };
  bool find_mode(Person& person, const Place& place) const;
  double add_person(Person& person, const Place& place, MixedGradient& scale, std::span<double> slopes,
                    PersonMoments& moments) const;

  const PeopleRows& rows_;
  double level_, least_lapse_;
  bool follow_ = true;
  std::vector<Person> people_;
  std::vector<PersonMoments> moments_;
  std::vector<double> nodes_, log_weights_;  ///< as in MixedLikelihood
};

}  // namespace stats
