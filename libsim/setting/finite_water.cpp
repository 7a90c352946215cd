#include "libsim/setting/finite_water.hpp"

#include <cmath>

#include "stats/base/error.hpp"

namespace sim {

namespace {
std::string first_of(const Simulation& fluid) {
  const auto divergence = fluid.divergence();
  return divergence ? "; first trouble: " + in_words(*divergence) : "";
}
}  // namespace

void check_finite(Simulation& fluid, const std::string& place) {
  const FrameReport report = fluid.report();
  const bool finite = std::isfinite(report.density_error_mean) && std::isfinite(report.speed_max_m_s);
  if (report.guards.not_finite == 0 && finite) return;
  throw base::Error(
      place,
      "the simulation failed: " + std::to_string(report.guards.not_finite) +
          " times a particle was not finite or far outside the tank, so its results cannot be used" +
          first_of(fluid),
      "use another time step, more substeps, or numbers of the solver nearer to the defaults");
}

}  // namespace sim
