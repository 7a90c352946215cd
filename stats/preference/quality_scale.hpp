#pragma once
/// One scale of quality from pairwise choices and ratings, in just-objectionable differences (JOD): the
/// better of two conditions that are 1 JOD apart is chosen in 75 % of answers (Thurstone 1927, case V;
/// Perez-Ortiz and Mantiuk 2017, arXiv 1712.03686). Ratings join the scale by a cumulative probit model.
///
///   P(i is chosen over j) = Phi((q_i - q_j + w) / jod_sigma), w only with ScaleOptions::order_bias
///   P(rating of i <= c)   = Phi(t_c - k q_i)
///
/// A person's own use of the rating scale is part of the scatter of ratings: normal offsets of people leave
/// the second equation a probit (k and t_c then count in standard deviations of all ratings). Answers of one
/// person depend on each other, so that intervals come from people: the jackknife, which leaves out one
/// person at a time, and beside it the sandwich estimator.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/result.hpp"

namespace stats {

/// Standard deviation of the difference of two conditions, JOD: Phi(1 / jod_sigma) = 0.75.
inline constexpr double jod_sigma = 1.4826022185056018;

/// Choices of one person between two conditions, shown in this order.
struct PairCount {
  int person = 0;                              ///< any number; equal numbers are one person
  int first = 0, second = 0;                   ///< conditions, from 0
  double first_chosen = 0, second_chosen = 0;  ///< numbers of answers, 0 or more
};

/// Equal ratings of one condition by one person.
struct RatingCount {
  int person = 0, condition = 0;
  int score = 0;
  double count = 1;
};

struct ScaleData {
  int conditions = 0;
  std::vector<PairCount> pairs;
  std::vector<RatingCount> ratings;
  /// False: nobody knows which answers are of one person. There are then no intervals and no observers.
  bool people_known = true;
};

enum class ScalePrior {
  None,  ///< maximum likelihood; refused where a condition wins or loses every comparison with the others
  /// Each q is normal about the mean of all, with a standard deviation of prior_sd_jod; k is normal about 0,
  /// with one of prior_sd_slope. Always finite.
  Normal,
  /// The prior "bounded" of pwcmp (2017), for comparison with its results. A pair whose answers are unanimous
  /// favours a small range of the scale. With its n answers and r = 1 + max q - min q it adds (log(1/r + 0.1)
  /// + log(max(0, 1/r - n/r^2) + 0.1)) / 2 to the log-likelihood. It does not make a separated scale finite.
  Bounded
};
inline constexpr double prior_sd_jod = 5, prior_sd_slope = 2;

struct ScaleOptions {
  ScalePrior prior = ScalePrior::None;
  bool order_bias = false;  ///< estimates w, the bias towards the condition shown first
  double confidence = 0.95;
};

/// Reasons why there is no scale, whose remedies differ from those of other reasons.
inline constexpr const char* no_order_bias = "the orders of showing do not determine the order bias";
inline constexpr const char* no_common_unit =
    "no two of the rated conditions are linked by choices, so that ratings have no unit in JOD";

/// Difference of two conditions, JOD. `se`, `ci` and `p` are over people (jackknife); empty without
/// intervals.
struct ScaleDifference {
  int i = 0, j = 0;          ///< i < j
  double jod = 0;            ///< q_i - q_j
  double probability = 0.5;  ///< that i is chosen over j, without order bias
  std::optional<double> se{}, p{};
  std::optional<std::array<double, 2>> ci{};
};

/// How one person's answers agree with the scale of all others (pwcmp's analysis of outliers).
struct ScaleObserver {
  int person = 0;
  double answers = 0;          ///< choices and ratings
  double log_likelihood = 0;   ///< natural log of the probability of the answers under the others' scale; of
                               ///< choices with the binomial coefficients, as in pwcmp
  double log_probability = 0;  ///< the same without binomial coefficients: of the single answers
  /// Distance below the lower quartile of all people's log-likelihoods, in interquartile ranges (quantiles of
  /// Hazen, type 5); 0 above. Look at a person from about 1.5. People with more answers have lower sums, so
  /// that the second score takes log_probability / answers. 0 if the range is 0.
  double score = 0, score_per_answer = 0;
};

struct QualityScale {
  std::vector<double> jod;                          ///< by condition; sum 0
  std::optional<double> order_bias, order_bias_se;  ///< w and its standard error over people, JOD
  std::optional<double> slope, slope_se;            ///< k; with ratings only
  std::vector<int> levels;                          ///< ratings that occur, ascending
  std::vector<double> thresholds;                   ///< t_c, one fewer than levels
  double log_likelihood = 0;                        ///< leaves out the prior and binomial coefficients
  double choices = 0, ratings = 0;
  std::vector<double> model_covariance;  ///< of `jod`, row after row, as if all answers were independent

  int people = 0;                ///< 0 if people are not known
  std::string why_no_intervals;  ///< empty if there are intervals; may name conditions as "item 1"
  std::optional<int> without{};  ///< the person without whom there is no scale, if that is why
  std::vector<double> se;  ///< of `jod`, jackknife over people, Student's t of people - 1; empty without
  std::vector<double> se_sandwich;  ///< the same by the sandwich, times people / (people - 1)
  std::vector<std::array<double, 2>> ci;
  std::vector<ScaleDifference> differences;  ///< all pairs
  std::vector<ScaleObserver> observers;      ///< in order of first appearance; empty without intervals
};

/// Sets the scores of the observers from their log-likelihoods, which may be sums over several scales. Does
/// nothing for no observers.
void score_observers(std::vector<ScaleObserver>& observers);

/// The groups of conditions that answers link: conditions that were compared, and all that were rated. One
/// group: the scale has one unit and one zero. std::invalid_argument as for quality_scale().
std::vector<std::vector<int>> linked_groups(const ScaleData& data);

/// Fits the scale. Refused: fewer than two conditions; no choice (ratings alone have no JOD); several
/// linked_groups(); no_common_unit; no_order_bias; ratings that differ where choices do not, so that k has no
/// bound; an infinite estimate (the reason names conditions as "item 1",
/// from 1). Intervals need three people, and a fit without each of them. std::invalid_argument: a condition
/// outside [0, conditions), equal conditions in a pair, a count that is negative or not finite, a confidence
/// outside (0, 1).
Result<QualityScale> quality_scale(const ScaleData& data, const ScaleOptions& options = {});

}  // namespace stats
