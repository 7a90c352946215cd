#include "stats/inference/unanimous.hpp"

#include <algorithm>
#include <cmath>

namespace stats {

double Unanimous::p(Alternative alternative, double null) const {
  if (value == null) return 1;
  const double tail = std::exp2(-static_cast<double>(n));
  if (alternative == Alternative::TwoSided) return std::min(1.0, 2 * tail);
  return (value > null) == (alternative == Alternative::Greater) ? tail : 1;
}

std::optional<Unanimous> unanimous(std::span<const double> values) {
  Unanimous out;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    if (out.n++ == 0) out.value = value;
    if (value != out.value) return {};
  }
  if (out.n < 2) return {};
  return out;
}

std::optional<Unanimous> unanimous(const ExactDifferences& differences) {
  auto out = unanimous(differences.numerators);
  if (out) out->value /= differences.denominator;
  return out;
}

}  // namespace stats
