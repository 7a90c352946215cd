#pragma once
/// The nozzles of a run, what they have poured and where it came from.

#include <vector>

#include "libsim/flow/corner_columns.hpp"
#include "libsim/flow/exchange.hpp"
#include "libsim/scene/nozzle.hpp"

namespace sim::SIM_BACKEND {

struct Jets {
  std::vector<Nozzle> nozzles;
  std::vector<Poured> before;   ///< of each nozzle, in layers of its present level
  double finest_spacing_m = 0;  ///< d_*
  double frame_dt_s = 0;        ///< > 0
  Corners corners;
  bool by_target = false;  ///< the layers' level follows the targets round the mouth
  int level = 0;           ///< of the particles that are poured
  int frame = 0;           ///< the frame that begins
  bool pouring = false;    ///< this frame began with new layers
  CornerColumns columns;
  Exchange exchange;
  Array<int> mass_by_target;   ///< near a mouth
  std::int64_t reservoir = 0;  ///< taken from the corners and not yet poured, in m_*
  std::int64_t poured = 0;     ///< since the run began, in m_*
  std::int64_t made = 0;       ///< particles that this added since the run began
  std::int64_t taken = 0;      ///< particles that it took from the corners
  std::uint64_t waited = 0;    ///< layers left out because the corners held too little
};

}  // namespace sim::SIM_BACKEND
