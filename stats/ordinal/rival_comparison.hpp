#pragma once
/// Compares rival models by cross-validation over people: each person's answers are predicted by fits without
/// this person. People are the unit of every difference and standard error.

#include <cstdint>
#include <string>
#include <vector>

#include "stats/ordinal/rival_fit.hpp"

namespace stats {

/// Least number of people to compare models. Below it, a standard error over people says little.
inline constexpr int least_people_to_compare = 8;

struct RivalComparisonOptions {
  int folds = 0;           ///< 0: leave one person out; else 2 or more groups of people, dealt at random
  std::uint64_t seed = 1;  ///< of the groups
  RivalOptions fit;
};

/// A model with its scores. Vectors over people are in the order of RivalAnswers::person.
struct RivalScore {
  std::string name;
  Result<RivalFit> fit = Refusal{"not computed"};  ///< to all answers; the reason why the model is left out
  std::vector<double> by_person;  ///< log probability of each person's answers, by a fit without the person
  double total = 0;               ///< sum of by_person
  /// This total minus that of the best model, and its standard error over people; 0 for the best model.
  double behind = 0, behind_se = 0;
  double weight = 0;                               ///< stacking weight
  std::vector<std::vector<double>> probabilities;  ///< of each answer's scores, by a fit without the person
};

/// A difference of total log scores (a minus b) with its standard error, sqrt(n) times the SD of the people's
/// differences.
struct RivalLead {
  double difference = 0, se = 0;
  /// True beyond two standard errors and beyond least_lead. The standard error of a small difference is too
  /// small: between a model and one that contains it, people's differences vary little, whichever is true
  /// (Sivula, Magnusson and Vehtari 2020, arXiv:2008.10296, who give 4 as the bound of small differences).
  bool leads() const { return difference > 2 * se && difference > least_lead; }
  static constexpr double least_lead = 4;
};
RivalLead rival_lead(std::span<const double> a, std::span<const double> b);

enum class RivalVerdict {
  Winner,     ///< one model leads every rival by more than two standard errors, and the reference predicts no
              ///< better
  Undecided,  ///< several models are in the running; or one, but the reference predicts better, by less than
              ///< that
  NoneFits    ///< the reference leads the best rival by more than two standard errors
};

struct RivalComparison {
  std::vector<RivalScore> models;  ///< as given
  std::vector<int> order;          ///< indices of the models that were fitted, the best first
  /// Indices of the models that the best one does not lead by more than two standard errors; the best first.
  std::vector<int> in_the_running;
  RivalVerdict verdict = RivalVerdict::Undecided;
  int people = 0;
  std::size_t answers = 0;
};

/// Consecutive groups of people: those with the numbers first to first + count - 1.
struct RivalGroups {
  int first = 0, count = 0;
};
/// Number of groups of people that are left out in turn. std::invalid_argument for one fold or more folds
/// than people.
int rival_group_count(int people, const RivalComparisonOptions& options);
/// Fits of one model, each without the people of one of the groups. All are refused if the fit to all answers
/// is. std::invalid_argument as compare_rivals().
std::vector<Result<RivalFit>> fit_without_groups(const RivalModel& model, const RivalAnswers& answers,
                                                 const RivalComparisonOptions& options, RivalGroups groups);

/// Fits and scores all models. `reference`: index of the model with a free value for each setting, which is
/// compared but cannot win; -1: none. Refused: fewer than least_people_to_compare people, or fewer than two
/// models (the reference left out) that can be fitted. std::invalid_argument as RivalFitter, and for one fold
/// or more folds than people. `without`: for each model the fits without each group, if fit_without_groups()
/// has computed them (std::invalid_argument for another number); none: they are computed here.
Result<RivalComparison> compare_rivals(const std::vector<RivalModel>& models, const RivalAnswers& answers,
                                       int reference, const RivalComparisonOptions& options,
                                       const std::vector<std::vector<Result<RivalFit>>>* without = nullptr);

/// Weights w >= 0 with sum 1 that maximise sum over people of log(sum over models of w exp(score)) (stacking
/// of predictive distributions; Yao and others 2018, Bayesian Anal. 13, 917-1007). scores[model][person].
/// std::invalid_argument without models, or if a score is not finite.
std::vector<double> stacking_weights(const std::vector<std::vector<double>>& scores);

/// How well a model can imitate a predictor: R^2 of the least squares fit of `target` by a + k v + q v^2,
/// with v = x_1, or v = x_1 - c x_2 at the best c. All columns have one length, with one value for each
/// setting (std::invalid_argument, also without columns or with more than two). 0 if `target` or x_1 does not
/// vary.
double imitated_share(std::span<const double> target, const std::vector<std::vector<double>>& x);

}  // namespace stats
