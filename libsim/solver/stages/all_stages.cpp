#include "libsim/solver/stages/stages.hpp"

namespace sim::SIM_BACKEND {

#ifdef VIP_NO_EFFECTS
#define SIM_STAGES_OF_EFFECTS(DO)
#else
#define SIM_STAGES_OF_EFFECTS(DO) SIM_EFFECTS(DO)
#endif

#define SIM_DECLARE(Name, word, ...) std::vector<Stage> word##_stages();
SIM_STAGES_OF_EFFECTS(SIM_DECLARE)
#undef SIM_DECLARE

namespace {

/// The stages of all effects, in the order of SIM_EFFECTS.
std::vector<Stage> effect_stages() {
  std::vector<Stage> out;
  [[maybe_unused]] const auto add = [&](EffectKind kind, std::vector<Stage> stages) {
    for (Stage& stage : stages) {
      stage.effect = kind;
      stage.source = traits_of(kind).source;
      stage.changes = stage.writes.has(Column::Velocity) ? Change::Effects : Change::None;
      out.push_back(stage);
    }
  };
#define SIM_ADD(Name, word, ...) add(EffectKind::Name, word##_stages());
  SIM_STAGES_OF_EFFECTS(SIM_ADD)
#undef SIM_ADD
  return out;
}

}  // namespace

#ifdef VIP_NO_EFFECTS
std::vector<SharedLoop> shared_loops() { return {}; }
#endif

std::vector<Stage> all_stages() {
  const std::vector<Stage> effects = effect_stages();
  std::vector<Stage> out{frame_neighbours_stage(), gaze_targets_stage(), saliency_stage(),
                         saliency_parts_stage(), forced_targets_stage(), opening_targets_stage(),
                         graded_targets_stage(), split_and_merge_stage(),
                         // The nozzle stage comes after all stages that use the last substep's neighbour
                         // lists, because pouring invalidates the lists.
                         nozzle_stage(), activation_stage(), obstacles_stage(), bodies_move_stage(),
                         bodies_meet_stage(), forces_stage(), present_neighbours_stage()};
  const auto add = [&](bool before_moves) {
    for (const Stage& stage : effects)
      if ((stage.phase == Phase::Substep) == before_moves) out.push_back(stage);
  };
  add(true);
  out.insert(out.end(),
             {predict_stage(), held_at_walls_stage(), neighbours_stage(), ease_stage(),
              pre_stabilisation_stage(), parting_stage(), coarse_pressure_stage(), wall_cells_stage(),
              before_projections_stage(), density_stage(), missing_density_stage(), displacement_stage(),
              velocity_stage(), xsph_stage(), xsph_of_short_steps_stage(), xsph_of_levels_stage()});
  add(false);
  // bodies_pushed_stage comes after all stages that push bodies.
  out.insert(out.end(), {bodies_pushed_stage(), velocity_grid_stage(), settling_stage(), outflow_stage()});
  return out;
}

}  // namespace sim::SIM_BACKEND
