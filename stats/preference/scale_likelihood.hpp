#pragma once
/// The likelihood of a scale of quality and its maximum, for quality_scale().

#include <span>
#include <string>
#include <vector>

#include "stats/preference/quality_scale.hpp"
#include "stats/result.hpp"

namespace stats {

/// Answers summed over people, or those of one person.
struct ScaleAnswers {
  std::vector<PairCount> pairs;
  std::vector<RatingCount> ratings;
};

/// The places of the parameters: q of all conditions but the first, w, k, thresholds.
struct ScaleLayout {
  int conditions = 0;
  bool order = false;
  std::vector<int> levels = {};  ///< scores that occur, ascending; empty without ratings

  std::size_t order_place() const { return static_cast<std::size_t>(conditions) - 1; }
  std::size_t slope_place() const { return order_place() + (order ? 1 : 0); }
  std::size_t size() const { return slope_place() + levels.size(); }
  /// The value of a condition; that of condition 0 is 0.
  static double value(std::span<const double> x, int condition) {
    return condition == 0 ? 0 : x[static_cast<std::size_t>(condition) - 1];
  }
  static void add(std::span<double> x, int condition, double value) {
    if (condition > 0) x[static_cast<std::size_t>(condition) - 1] += value;
  }
};

/// Log-likelihood of the answers, without binomial coefficients; adds its gradient to `gradient`. A score
/// that is not among the levels counts as the next lower level, or as the lowest.
double scale_log_likelihood(const ScaleAnswers& answers, const ScaleLayout& layout, std::span<const double> x,
                            std::span<double> gradient);

/// The answers of all people, without one of them if `left_out` is given.
ScaleAnswers summed_answers(const ScaleData& data, const int* left_out);

/// Groups of conditions that are linked by choices and, if `by_ratings`, by ratings.
std::vector<std::vector<int>> answer_groups(const ScaleAnswers& answers, int conditions, bool by_ratings);

/// A maximum of the likelihood times the prior.
struct ScaleMaximum {
  ScaleLayout layout;
  ScaleAnswers answers;
  std::vector<double> x;        ///< the parameters, as `layout` places them
  std::vector<double> inverse;  ///< inverse of the negative Hessian; empty if the fit began near another one
  double log_likelihood = 0;

  /// The values of all conditions; sum 0.
  std::vector<double> jod() const;
};

/// Fits all answers, or all but those of `left_out`. `near`: a maximum of similar data, from which the fit
/// begins if it has the same parameters; or null. Refused as quality_scale().
Result<ScaleMaximum> maximise_scale(const ScaleData& data, const ScaleOptions& options, const int* left_out,
                                    const ScaleMaximum* near);

}  // namespace stats
