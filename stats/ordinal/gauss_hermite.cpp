#include "stats/ordinal/gauss_hermite.hpp"

#include <gsl/gsl_integration.h>

#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <stdexcept>

#include "stats/gsl_errors.hpp"

namespace stats {

GaussHermite gauss_hermite(int points) {
  use_gsl_codes();
  if (points < 1) throw std::invalid_argument("gauss_hermite: quadrature without nodes; give points from 1");
  const std::unique_ptr<gsl_integration_fixed_workspace, decltype(&gsl_integration_fixed_free)> rule(
      gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, static_cast<std::size_t>(points), 0, 1, 0,
                                  0),
      &gsl_integration_fixed_free);
  if (!rule) throw std::bad_alloc();
  GaussHermite out;
  for (int k = 0; k < points; ++k) {
    const double z = gsl_integration_fixed_nodes(rule.get())[k];
    const double w = gsl_integration_fixed_weights(rule.get())[k];
    out.nodes.push_back(std::numbers::sqrt2 * z);
    out.log_weights.push_back(std::log(w) + z * z - std::log(std::numbers::pi) / 2);
  }
  return out;
}

}  // namespace stats
