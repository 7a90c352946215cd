#pragma once
/// Tipping-point analysis: how much worse than expected missing answers must be before a decision changes. It
/// uses a pattern mixture (Little 1994; Ratitch, O'Kelly and Tosiello 2013). Participants who were planned to
/// judge both methods but lack one are assumed to differ like the others, except that their answers to one
/// method are worse by `shift` points. The mean difference over all participants then changes by `shift`
/// times the share of those participants; its standard error stays that of the observed answers.

#include <limits>
#include <optional>
#include <string>

#include "stats/analysis/score_table.hpp"
#include "stats/result.hpp"

namespace stats {

/// Missing answers to one method of a pair.
struct MissingAnswers {
  std::size_t missing = 0;  ///< participants without answers to the method, of those planned to judge both
  double room = 0;          ///< points by which the expected answers can become worse before they leave the
                            ///< scale
  std::optional<double> shift;  ///< points by which these answers must be worse than expected to change the
                                ///< decision; empty: no shift does, or unknown
  bool within_scale() const { return shift && *shift <= room; }
};

struct TippingPoint {
  std::size_t planned = 0;  ///< participants planned to judge both
  bool holds = false;       ///< the decision on the observed answers
  MissingAnswers a, b;
  std::string reason;  ///< why the shifts are unknown; empty if they are known
};

/// Range of estimates a - b for which a decision holds; either end may be infinite. Empty if low >= high.
struct DecisionRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
};

/// The shifts of missing answers at which the estimate of a - b enters or leaves the range in which the
/// decision holds. `a` and `b` are method indices of the table. Refused if no participant judged both.
Result<TippingPoint> tipping_point(const ScoreTable& table, int n_star, int a, int b, double estimate,
                                   DecisionRange holds);

/// Shifts for a two-sided test against zero, at which the difference becomes significant or stops being
/// significant. `half` is the half width of the interval of 1 - alpha about the estimate.
Result<TippingPoint> tipping_point_two_sided(const ScoreTable& table, int n_star, int a, int b,
                                             double estimate, double half);

/// Counts the missing answers and leaves the shifts empty: for differences that are all equal and so have no
/// standard error.
Result<TippingPoint> no_tipping_point(const ScoreTable& table, int n_star, int a, int b, bool holds);

}  // namespace stats
