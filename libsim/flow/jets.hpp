#pragma once
/// The nozzles of a run: what they have poured and where it came from.

#include <vector>

#include "libsim/flow/corner_columns.hpp"
#include "libsim/flow/exchange.hpp"
#include "libsim/scene/nozzle.hpp"

namespace sim::SIM_BACKEND {

struct Jets {
  std::vector<Nozzle> nozzles;
  std::vector<Poured> before;   ///< per nozzle, in layers of its present level
  double finest_spacing_m = 0;  ///< d_*
  double frame_dt_s = 0;        ///< > 0
  Corners corners;
  bool by_target = false;  ///< the level of the layers follows the targets around the mouth
  int level = 0;           ///< of the poured particles
  int frame = 0;           ///< number of the frame that begins
  bool pouring = false;    ///< this frame started with new layers
  CornerColumns columns;
  Exchange exchange;
  Array<int> mass_by_target;   ///< near a mouth
  std::int64_t reservoir = 0;  ///< taken from the corners and not yet poured, in m_*
  std::int64_t poured = 0;     ///< since the run began, in m_*
  std::int64_t made = 0;       ///< particles added by pouring since the run began
  std::int64_t taken = 0;      ///< particles taken from the corners
  std::uint64_t waited = 0;    ///< layers not poured because the corners held too little mass
};

}  // namespace sim::SIM_BACKEND
