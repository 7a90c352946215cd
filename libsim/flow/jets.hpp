#pragma once
/// The nozzles of a run and what they have poured.

#include <vector>

#include "libsim/flow/corner_columns.hpp"
#include "libsim/scene/nozzle.hpp"

namespace sim::SIM_BACKEND {

struct Jets {
  std::vector<Nozzle> nozzles;
  double spacing_m = 0;   ///< d of the particles that are poured
  double frame_dt_s = 0;  ///< > 0
  Corners corners;
  int frame = 0;  ///< the frame that begins
  CornerColumns columns;
  std::uint64_t poured = 0;  ///< particles, since the run began
  std::uint64_t waited = 0;  ///< layers left out because the corners held too few particles
};

}  // namespace sim::SIM_BACKEND
