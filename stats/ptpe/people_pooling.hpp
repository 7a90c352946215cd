#pragma once
/// The penalised maximum of the marginal likelihood of people_likelihood.hpp, with the covariance of its
/// parameters.

#include <functional>
#include <span>
#include <vector>

#include "stats/ordinal/level_thresholds.hpp"
#include "stats/ptpe/people_fit.hpp"
#include "stats/ptpe/people_likelihood.hpp"

namespace stats {

/// Least lapse rate that is estimated: no answer is then impossible.
inline constexpr double least_people_lapse = 0.005;

/// The model's parameters, in the order of PeopleLikelihood, of which PeopleOptions hold some. Refers to rows
/// and options, which must live as long.
class PeoplePooling {
 public:
  PeoplePooling(const PeopleRows& rows, double level, const PeopleOptions& options);

  /// Maximises the likelihood times the priors from values of all parameters; false: no convergence.
  bool fit(std::vector<double> start);

  /// The estimates of all parameters.
  const std::vector<double>& at() const { return at_; }
  double parameter(std::size_t i) const { return at_[rows_.gaps() + i]; }  ///< i: of PeopleAt
  bool varies(std::size_t i) const;                                        ///< false: held
  /// Covariance of two estimates, from the observed information.
  double covariance(std::size_t i, std::size_t j) const;
  /// Standard error of a function of the parameters (delta method).
  double se(const std::function<double(const PeoplePooling&)>& of);
  double log_likelihood() const { return log_likelihood_; }  ///< without the priors
  LevelThresholds thresholds() const;
  /// The spread over people: the covariance of (alpha, beta).
  PersonMoments spread() const;
  /// Of each person, given the person's answers and the estimates.
  const std::vector<PersonMoments>& moments() const { return likelihood_.moments(); }
  /// The same with the covariance of the means by the estimates' uncertainty added (Kass and Steffey 1989).
  std::vector<PersonMoments> whole_moments();
  const PeopleLikelihood& likelihood() const { return likelihood_; }

 private:
  double deviance(std::span<const double> x, std::span<double> slope);
  std::vector<double> free_values() const;
  double quadratic(std::span<const double> a, std::span<const double> b) const;
  std::size_t place(std::size_t i) const;

  const PeopleRows& rows_;
  const PeopleOptions& options_;
  double level_;
  PeopleLikelihood likelihood_;
  std::vector<std::size_t> free_;  ///< the parameters that are not held
  std::vector<double> at_, covariance_;
  double log_likelihood_ = 0;
};

}  // namespace stats
