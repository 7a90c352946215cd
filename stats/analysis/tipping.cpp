#include "stats/analysis/tipping.hpp"

#include <algorithm>
#include <cmath>

namespace stats {

namespace {

/// Counts of participants planned to judge both methods.
struct Seen {
  std::size_t planned = 0, both = 0, missing_a = 0, missing_b = 0;
  double mean_a = 0, mean_b = 0;  ///< means of the participants who judged both
};

Seen count(const ScoreTable& table, int n_star, int a, int b) {
  Seen out;
  const auto x = table.column(n_star, a), y = table.column(n_star, b);
  const auto planned_a = table.planned(n_star, a), planned_b = table.planned(n_star, b);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!planned_a[i] || !planned_b[i]) continue;
    ++out.planned;
    out.missing_a += std::isnan(x[i]) ? 1 : 0;
    out.missing_b += std::isnan(y[i]) ? 1 : 0;
    if (std::isnan(x[i]) || std::isnan(y[i])) continue;
    ++out.both;
    out.mean_a += x[i];
    out.mean_b += y[i];
  }
  if (out.both > 0) {
    out.mean_a /= static_cast<double>(out.both);
    out.mean_b /= static_cast<double>(out.both);
  }
  return out;
}

double room_of(const ScoreScale& scale, double mean) {
  return scale.higher_is_better ? mean - scale.min : scale.max - mean;
}

/// Decrease at which an estimate enters the range from above or leaves it below. Empty if no decrease does.
std::optional<double> way_down(double estimate, DecisionRange holds) {
  const double edge = estimate > holds.high ? holds.high : holds.low;
  if (estimate < holds.low || std::isinf(edge) || holds.low >= holds.high) return {};
  return estimate - edge;
}

std::optional<double> shift_of(std::optional<double> way, std::size_t missing, std::size_t planned) {
  if (!way || missing == 0) return {};
  return *way * static_cast<double>(planned) / static_cast<double>(missing);
}

}  // namespace

Result<TippingPoint> tipping_point(const ScoreTable& table, int n_star, int a, int b, double estimate,
                                   DecisionRange holds) {
  const Seen seen = count(table, n_star, a, b);
  if (seen.both == 0) return Refusal{"no participant judged both methods"};
  TippingPoint out;
  out.planned = seen.planned;
  out.holds = estimate >= holds.low && estimate <= holds.high;
  const auto down = way_down(estimate, holds);
  const auto up = way_down(-estimate, {-holds.high, -holds.low});
  const ScoreScale& scale = table.scale();
  const bool a_falls = scale.higher_is_better;  // the estimate a - b falls as a becomes worse
  out.a = {seen.missing_a, room_of(scale, seen.mean_a),
           shift_of(a_falls ? down : up, seen.missing_a, seen.planned)};
  out.b = {seen.missing_b, room_of(scale, seen.mean_b),
           shift_of(a_falls ? up : down, seen.missing_b, seen.planned)};
  return out;
}

Result<TippingPoint> tipping_point_two_sided(const ScoreTable& table, int n_star, int a, int b,
                                             double estimate, double half) {
  const auto undecided = tipping_point(table, n_star, a, b, estimate, {-half, half});
  if (!undecided) return undecided;
  TippingPoint out = *undecided;
  out.holds = !out.holds;
  return out;
}

Result<TippingPoint> no_tipping_point(const ScoreTable& table, int n_star, int a, int b, bool holds) {
  const auto counted = tipping_point(table, n_star, a, b, 0, {});
  if (!counted) return counted;
  TippingPoint out = *counted;
  out.holds = holds;
  out.reason = "all differences are equal, so their standard error is zero and no shift can be computed";
  return out;
}

}  // namespace stats
