#pragma once
/// Turns a Demand, the requirements of a scene, a method and the outputs, into a Schedule: selects the
/// required stages in their fixed order, and checks that each column is written before it is read.

#include <string>
#include <vector>

#include "libsim/simulation.hpp"
#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

struct Schedule {
  std::vector<Stage> frame_start, substep, iteration, substep_end, frame_end;
  std::size_t passes = 0;  ///< number of passes in all phases
  ColumnSet columns;       ///< all columns that the passes read or write, and those of a paused activation
  /// An effect keeps particles from resting (Demand::keeps_all_solved). The columns of the stage activation
  /// stay, so that rests can begin again when the effect is turned off.
  bool activation_paused = false;
  std::string explanation;  ///< why each pass runs, and why each other known stage does not
};

/// Drops stages that are not required. The order changes only if two passes of one phase can share one of
/// `loops`: the later pass then runs together with the earlier one. Two passes can share a loop only if
/// neither the earlier pass nor any pass between them accesses a column that the later pass writes, or writes
/// a column that the later pass reads. base::Error if a pass reads a column that no earlier pass has written;
/// the error names the pass and the column.
Schedule compile_schedule(const Demand& demand, const std::vector<Stage>& stages = all_stages(),
                          const std::vector<SharedLoop>& loops = shared_loops());

/// The passes in their order, with their last measured times.
std::vector<StageTime> stage_times(const Schedule& schedule, const PassClock& clock);

/// Runs the passes of one frame: those of the frame's start; in each substep the substep's passes, in each
/// iteration the iteration's passes, then the passes of the substep's end; last those of the frame's end.
void run_frame(const Schedule& schedule, FluidState& state);

}  // namespace sim::SIM_BACKEND
