#include "stats/ordinal/link.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "stats/quantiles.hpp"

namespace stats {

const char* link_name(Link link) { return link == Link::Logit ? "logit" : "probit"; }

LinkValue link_value(Link link, double x) {
  if (std::isinf(x)) return {x > 0 ? 1.0 : 0.0, 0, 0, 0};
  if (link == Link::Logit) {
    const double e = std::exp(-std::abs(x)), small = e / (1 + e), large = 1 / (1 + e);
    const double F = x < 0 ? small : large, f = small * large;
    return {F, f, f * (x < 0 ? large - small : small - large), f * (1 - 6 * f)};
  }
  const double f = std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
  return {std::erfc(-x / std::numbers::sqrt2) / 2, f, -x * f, (x * x - 1) * f};
}

double link_quantile(Link link, double p) {
  if (link == Link::Probit) return normal_quantile(p);
  if (!(p > 0 && p < 1)) throw std::invalid_argument("a probability must lie between 0 and 1");
  return std::log(p) - std::log1p(-p);
}

CategoryTerm category_term(Link link, double lower, double upper, double location) {
  const auto a = link_value(link, upper - location), c = link_value(link, lower - location);
  // Above the middle the difference of the upper tails is more accurate: F(x) = 1 - F(-x).
  const double p = lower > location
                       ? link_value(link, location - lower).F - link_value(link, location - upper).F
                       : a.F - c.F;
  CategoryTerm t;
  if (!(p > std::numeric_limits<double>::min())) {
    t.log_p = -std::numeric_limits<double>::infinity();
    return t;
  }
  t.log_p = std::log(p);
  // Derivatives of P with respect to v, divided by P (n1, n2, n3), then those of log P.
  const double n1 = (c.f - a.f) / p, n2 = (a.f1 - c.f1) / p, n3 = (c.f2 - a.f2) / p;
  t.d1 = n1;
  t.d2 = n2 - n1 * n1;
  t.d3 = n3 - 3 * n2 * n1 + 2 * n1 * n1 * n1;
  const auto threshold = [&](double f, double f1, double f2, double& d, double& dv, double& dvv) {
    d = f;
    dv = -f1 - f * n1;
    dvv = f2 + 2 * f1 * n1 - f * n2 + 2 * f * n1 * n1;
  };
  threshold(a.f / p, a.f1 / p, a.f2 / p, t.up, t.up1, t.up2);
  threshold(-c.f / p, -c.f1 / p, -c.f2 / p, t.lo, t.lo1, t.lo2);
  t.up_up = a.f1 / p - t.up * t.up;
  t.lo_lo = -c.f1 / p - t.lo * t.lo;
  t.up_lo = -t.up * t.lo;
  return t;
}

}  // namespace stats
