#pragma once
/// Rival models of what people notice, fitted to the same answers: cumulative probit models in which each
/// model has a predictor v of its own, such as the 95th percentile of the frame time.
///
///   P(Y <= j) = (1 - lapse) Phi(theta_j - L - s_p) + lapse (j + 1) / choices,   s_p ~ N(0, sd^2)
///   L = k v + q v^2,   v = x_1 - c_2 x_2 - c_3 x_3 ...
///
/// The thresholds hold the level of the answers. Predictors are standardised over all rows. A weak normal
/// prior keeps coefficients finite where a predictor separates the answers.

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/ordinal/cumulative_link.hpp"
#include "stats/result.hpp"

namespace stats {

/// Answers to one question with listed scores. All columns have one length.
struct RivalAnswers {
  std::vector<int> score;   ///< index on the question's scale, 0 to choices - 1
  std::vector<int> person;  ///< 0 to people - 1
  int choices = 7;          ///< number of scores on the scale
  int people = 0;

  std::size_t n() const { return score.size(); }
};

/// A model by its predictors, with one finite value for each answer.
struct RivalModel {
  std::string name;
  std::vector<Predictor> predictors;
  /// false: L = k v + q v^2 as above. true: L is the sum of all predictors times coefficients of their own;
  /// without predictors L = 0.
  bool linear = false;
};

struct RivalOptions {
  int points = 5;  ///< nodes of the quadrature over a person's effect; 1 = Laplace
  double prior_sd =
      5;  ///< SD of the normal prior of each threshold and standardised coefficient; infinity: none
  double least_lapse = 0.005;        ///< lower bound of the lapse rate, so that no answer is impossible
  std::optional<double> lapse = {};  ///< a fixed lapse rate, 0 to 0.5; none: estimated, up to 0.5
};

struct RivalFit {
  std::vector<int> scores;         ///< the scores that occur, ascending
  std::vector<double> thresholds;  ///< one fewer than `scores`
  /// Of the standardised predictors: k, q, c_2, c_3 ..., or one for each predictor of a linear model.
  std::vector<double> coefficients;
  double sd_person = 0;
  double lapse = 0;
  double log_likelihood = 0;
  int parameters = 0;  ///< number of estimated parameters
};

/// Fits one model to all answers, or to those of some people, and scores the answers of others.
class RivalFitter {
 public:
  /// std::invalid_argument if columns differ in length, a number is out of its range or a value is not
  /// finite.
  RivalFitter(RivalModel model, const RivalAnswers& answers, const RivalOptions& options);
  ~RivalFitter();
  RivalFitter(RivalFitter&&) noexcept;

  /// Fits all answers by maximum likelihood (times the prior). Refused: a predictor that does not vary; fewer
  /// than two people; all answers alike; no convergence.
  Result<RivalFit> fit();
  /// Fits the answers of the people p with in[p] != 0, started from fit(), which must have been called and
  /// not refused. Thread-safe.
  Result<RivalFit> fit_some(std::span<const char> in) const;

  /// Log probability of all answers of one person, integrated over the person's effect.
  double log_score(const RivalFit& fit, int person) const;
  /// Probability of each of the `choices` scores from a new person at one row, or at values of the
  /// predictors.
  std::vector<double> probabilities(const RivalFit& fit, std::size_t row) const;
  std::vector<double> probabilities(const RivalFit& fit, std::span<const double> values) const;
  /// The predictor in its own units at each row: x_1 - c_2 x_2 ..., up to a constant and a factor. For a
  /// model that is not linear.
  std::vector<double> combined(const RivalFit& fit) const;
  /// The coefficients c_2, c_3 ... in units of x_1 / x_j, as b of log mu - b delta.
  std::vector<double> ratios(const RivalFit& fit) const;

  const RivalModel& model() const;

 private:
  std::size_t whole_thresholds() const;  ///< number of thresholds of fit()

  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stats
