#pragma once
/// A stage: data, and a function that accesses only the columns it declares.

#include <optional>
#include <string>
#include <vector>

#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// What a scene, a method and the requested outputs require.
struct Demand {
  SolverParameters parameters;
  std::vector<Effect> effects;    ///< that the scene lists
  bool nozzles = false;           ///< the scene has one
  bool outlets = false;           ///< the scene has one
  bool moving_obstacles = false;  ///< the scene has one that moves along a given path
  bool free_obstacles = false;    ///< the scene has one that is moved by the water
  bool obstacles_meet = false;    ///< a free obstacle may meet another, or has friction
  bool settling = false;          ///< the gate is closed and the water comes to rest
  bool levels = false;            ///< particles split and merge
  bool forced_targets = false;    ///< a test gives their targets
  bool gaze_targets = false;      ///< targets follow the gaze alone
  bool saliency = false;          ///< targets follow saliency
  bool saliency_parts = false;    ///< an output needs the parts of saliency
  bool activation = false;        ///< temporal acceleration selects the solved particles
  bool wall_impulse = false;      ///< an output needs the walls' impulse on the water
};

enum class Phase { FrameStart, Substep, Iteration, SubstepEnd, FrameEnd };

/// Sums over neighbours that a stage computes, for stages that can share a loop (SharedLoop).
enum class SharedTerm { None, SurfaceNormals, Curl, Conduction };

struct Stage {
  const char* name;
  const char* source = "";  ///< paper and equation
  Phase phase;
  /// Returns the reason why the stage is required, or an empty string. An effect's stage needs no such
  /// function; with one it runs only if the function also requires it.
  std::string (*called_for)(const Demand&) = nullptr;
  Part part = Part::Solve;
  /// How its change of the water's momentum is booked; each stage that writes velocities has one.
  Change changes = Change::None;
  EffectKind effect = no_effect;  ///< the effect that alone requires the stage
  SharedTerm loop = SharedTerm::None;
  std::size_t place = 0;  ///< index among the passes of a schedule, set by the schedule
  // Set by stage_of from the function's view:
  ColumnSet reads = {}, writes = {};
  void (*run)(FluidState&) = nullptr;
};

namespace stage_detail {
template <class View>
View view_of(void (*)(FluidState&, View));
}

/// The stage that runs `function`, a void(FluidState&, ColumnView<...>): the stage declares the columns that
/// the view declares.
template <auto function>
Stage stage_of(Stage stage) {
  using View = decltype(stage_detail::view_of(function));
  stage.reads = View::reads;
  stage.writes = View::writes;
  stage.run = [](FluidState& state) { function(state, View(state.particles)); };
  return stage;
}

// Reasons shared by several stages.
inline std::string always_moves(const Demand&) { return "every method moves its particles"; }
inline std::string keeps_density(const Demand&) { return "every method keeps the density"; }
inline std::string if_levels(const Demand& demand) {
  return demand.levels ? "particles split and merge" : "";
}
inline std::string if_wall_impulse(const Demand& demand) {
  return demand.wall_impulse ? "the walls' impulse is asked for" : "";
}
inline std::string if_pushes(const Demand& demand) {
  const std::string asked = if_wall_impulse(demand);
  return asked.empty() && demand.free_obstacles ? "an obstacle is free" : asked;
}
inline std::string if_activation(const Demand& demand) {
  return demand.activation && !demand.settling ? "the method accelerates in time" : "";
}

}  // namespace sim::SIM_BACKEND
