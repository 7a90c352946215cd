#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

std::vector<Stage> all_stages() {
  return {nozzle_stage(),
          frame_neighbours_stage(),
          gaze_targets_stage(),
          saliency_stage(),
          saliency_parts_stage(),
          forced_targets_stage(),
          graded_targets_stage(),
          split_and_merge_stage(),
          activation_stage(),
          predict_stage(),
          held_at_walls_stage(),
          neighbours_stage(),
          ease_stage(),
          pre_stabilisation_stage(),
          parting_stage(),
          coarse_pressure_stage(),
          wall_cells_stage(),
          density_stage(),
          missing_density_stage(),
          displacement_stage(),
          velocity_stage(),
          xsph_stage(),
          xsph_of_levels_stage(),
          velocity_grid_stage(),
          settling_stage(),
          outflow_stage()};
}

}  // namespace sim::SIM_BACKEND
