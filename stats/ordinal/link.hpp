#pragma once
/// Link distributions of ratings: P(Y <= j) = F(theta_j - location), and the derivatives of log P(Y = j).

namespace stats {

enum class Link { Logit, Probit };

const char* link_name(Link link);  ///< "logit", "probit"

/// Distribution function F, its density f and the density's first two derivatives at x; 0 or 1 and zeros at
/// -+ infinity.
struct LinkValue {
  double F = 0, f = 0, f1 = 0, f2 = 0;
};
LinkValue link_value(Link link, double x);

/// x with F(x) = p, 0 < p < 1 (std::invalid_argument).
double link_quantile(Link link, double p);

/// log P of one rating, P = F(upper - v) - F(lower - v), and its derivatives: d1, d2, d3 with respect to the
/// location v; `up` and `lo` with respect to the upper and lower threshold, `up1`, `up2`, `lo1`, `lo2` of
/// those with respect to v.
struct CategoryTerm {
  double log_p = 0;
  double d1 = 0, d2 = 0, d3 = 0;
  double up = 0, up1 = 0, up2 = 0;
  double lo = 0, lo1 = 0, lo2 = 0;
  double up_up = 0, lo_lo = 0, up_lo = 0;  ///< second derivatives with respect to the thresholds
};

/// lower < upper; either may be infinite. log_p is -infinity where P is below the smallest double, and the
/// derivatives are then zero.
CategoryTerm category_term(Link link, double lower, double upper, double location);

}  // namespace stats
