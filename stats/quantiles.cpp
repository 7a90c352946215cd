#include "stats/quantiles.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/gsl_errors.hpp"

namespace stats {

namespace {
void require_open_unit(double p) {
  if (!(p > 0 && p < 1))
    throw std::invalid_argument(
        "student_quantile or normal_quantile: p is not between 0 and 1; give a probability in (0, 1)");
}
}  // namespace

double student_quantile(double p, double df) {
  use_gsl_codes();
  require_open_unit(p);
  if (!(df > 0)) throw std::invalid_argument("student_quantile: df is not above 0; give a larger number");
  return gsl_cdf_tdist_Pinv(p, df);
}

double normal_quantile(double p) {
  use_gsl_codes();
  require_open_unit(p);
  return gsl_cdf_ugaussian_Pinv(p);
}

double normal_probability(double z) {
  use_gsl_codes();
  return gsl_cdf_ugaussian_P(z);
}

double sorted_quantile(std::span<const double> ascending, double p) {
  if (ascending.empty())
    throw std::invalid_argument("sorted_quantile: there are no values; give at least one");
  if (!(p >= 0 && p <= 1))
    throw std::invalid_argument("sorted_quantile: p is not within [0, 1]; give a probability");
  const double at = p * static_cast<double>(ascending.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const auto high = std::min(low + 1, ascending.size() - 1);
  return std::lerp(ascending[low], ascending[high], at - static_cast<double>(low));
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return sorted_quantile(values, 0.5);
}

}  // namespace stats
