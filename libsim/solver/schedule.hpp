#pragma once
/// From what is wanted to what runs: keeps only the stages that are called for, in their fixed order, and
/// checks them.

#include <string>
#include <vector>

#include "libsim/simulation.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

struct Schedule {
  std::vector<Stage> frame_start, substep, iteration, substep_end, frame_end;
  std::size_t passes = 0;   ///< of all phases together
  ColumnSet columns;        ///< union of what the passes read and write
  std::string explanation;  ///< each pass with why it is there, each known stage with why it is not
};

/// Prunes, and reorders only where two passes of one phase share a loop: the later one then runs with the
/// earlier one, if nothing between them touches what it writes or writes what it reads. A pass that reads a
/// column nothing has written is an error (base::Error names both).
Schedule compile_schedule(const Demand& demand, const std::vector<Stage>& stages = all_stages(),
                          const std::vector<SharedLoop>& loops = shared_loops());

/// The passes in their order, with what the clock last measured of each.
std::vector<StageTime> stage_times(const Schedule& schedule, const PassClock& clock);

/// One frame: the frame's start, substeps x (substep passes, iterations x iteration passes, closing passes),
/// then the frame's end.
void run_frame(const Schedule& schedule, FluidState& state);

}  // namespace sim::SIM_BACKEND
