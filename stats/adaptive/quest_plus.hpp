#pragma once
/// QUEST+ (Watson 2017): chooses each stimulus so that the expected entropy of the parameters' posterior is
/// least.

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace stats {

/// A discrete Bayesian estimate of a model's parameters. Stimuli, parameters and outcomes are indices into
/// grids of the caller, of any number of dimensions. The time of one choice is proportional to stimuli x
/// parameter points x outcomes.
class QuestPlus {
 public:
  /// `likelihood(s, p, o)` is the probability of outcome o for stimulus s under parameters p; the
  /// probabilities of all o must sum to 1. `prior` has one weight of 0 or more for each parameter point; the
  /// sum need not be 1. `interest` gives each parameter point the index of its marginal cell: the points of a
  /// cell share the values of the parameters of interest. The entropy is computed over the cells, so that
  /// nuisance parameters do not affect the choice (Prins 2013). With an empty `interest` each point is its
  /// own cell. std::invalid_argument: no stimulus or outcome, a negative weight or none above 0, a
  /// probability outside [0, 1], or an `interest` of wrong length or with a negative index.
  QuestPlus(int stimuli, int outcomes, std::span<const double> prior,
            const std::function<double(int, int, int)>& likelihood, std::span<const int> interest = {});

  /// Expected entropy of the marginal cells after stimulus s, in nats.
  double expected_entropy(int stimulus) const;
  /// The stimulus of least expected entropy among those allowed (empty: all); of equal ones the first.
  /// Differences below 1e-15 count as equal, so rounding does not decide.
  int next(std::span<const int> allowed = {}) const;
  /// Bayes' rule. An outcome that every parameter point excludes leaves the posterior unchanged.
  /// std::invalid_argument for an index outside the grids.
  void update(int stimulus, int outcome);

  /// Probability of each parameter point; the sum is 1.
  std::span<const double> posterior() const { return posterior_; }
  /// Parameter point of the highest probability; of equal ones the first.
  int mode() const;
  /// Entropy of the marginal cells, in nats.
  double entropy() const;

 private:
  double chance(int stimulus, int outcome, std::size_t point) const {
    return likelihood_[(static_cast<std::size_t>(stimulus) * static_cast<std::size_t>(outcomes_) +
                        static_cast<std::size_t>(outcome)) *
                           posterior_.size() +
                       point];
  }

  int stimuli_, outcomes_;
  std::vector<double> posterior_;
  std::vector<double> likelihood_;  ///< [stimulus][outcome][parameter point]
  std::vector<int> interest_;       ///< marginal cell of each parameter point
  int cells_ = 0;                   ///< number of marginal cells
};

/// Summary of one parameter over a grid posterior.
struct GridEstimate {
  double mean = 0, sd = 0;
  double low = 0, high = 0;  ///< equal-tailed credible interval
};

/// `values[p]` is the parameter's value at point p, `weights` the posterior. Each distinct value represents
/// the range that reaches half-way to its neighbours. The probability is uniform within a range, so `low` and
/// `high` need not be grid values. std::invalid_argument: unequal lengths or no value.
GridEstimate grid_estimate(std::span<const double> values, std::span<const double> weights,
                           double confidence = 0.95);

}  // namespace stats
