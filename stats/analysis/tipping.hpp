#pragma once
/// How far missing answers would have to lie from what the others say before a decision changes: a
/// tipping-point analysis by a pattern mixture (Little 1994; Ratitch, O'Kelly and Tosiello 2013). Those who
/// were to judge both methods and did not are taken to differ like the others, but that their answers to one
/// method are worse by `shift` points; the mean difference over all then moves by shift times their share,
/// and its error stays that of the answers there are.

#include <limits>
#include <optional>
#include <string>

#include "stats/analysis/score_table.hpp"
#include "stats/result.hpp"

namespace stats {

/// Of one method of a pair.
struct MissingAnswers {
  std::size_t missing = 0;  ///< who lack it, of those who were to judge both
  double room =
      0;  ///< points that their answers can be worse before they leave the scale, as expected of them
  std::optional<double> shift;  ///< points by which they must be worse; empty: none is enough, or unknown
  bool within_scale() const { return shift && *shift <= room; }
};

struct TippingPoint {
  std::size_t planned = 0;  ///< participants who were to judge both
  bool holds = false;       ///< the decision on the answers there are
  MissingAnswers a, b;
  std::string reason;  ///< why no shift is known; empty: they are
};

/// Estimates a - b by which a decision is taken; either end may be infinite. Nothing holds where low >= high.
struct DecisionRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

/// When the estimate of a - b enters or leaves the range in which something `holds`. Methods are indices of
/// the table. Refused when nobody judged both.
Result<TippingPoint> tipping_point(const ScoreTable& table, int n_star, int a, int b, double estimate,
                                   DecisionRange holds);

/// The same of a difference tested against zero, two-sided: when it becomes significant, or is no longer.
/// `half` is the half width of the interval of 1 - alpha about the estimate.
Result<TippingPoint> tipping_point_two_sided(const ScoreTable& table, int n_star, int a, int b,
                                             double estimate, double half);

/// Of differences that are all equal, which have no error: who is missing, and that no shift is known.
Result<TippingPoint> no_tipping_point(const ScoreTable& table, int n_star, int a, int b, bool holds);

}  // namespace stats
