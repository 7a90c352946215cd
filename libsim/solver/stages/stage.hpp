#pragma once
/// What a stage is: data, and a function that reaches the columns that it declares and no others.

#include <optional>
#include <string>
#include <vector>

#include "libsim/solver/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// What a scene, a method and the wanted outputs call for.
struct Demand {
  SolverParameters parameters;
  std::vector<Effect> effects;    ///< that the scene lists
  bool nozzles = false;           ///< the scene has one
  bool outlets = false;           ///< the scene has one
  bool moving_obstacles = false;  ///< the scene has one that goes a way of its own
  bool free_obstacles = false;    ///< the scene has one that the water moves
  bool obstacles_meet = false;    ///< and that one may meet another, or has friction
  bool settling = false;          ///< the gate is closed and the water comes to rest
  bool levels = false;            ///< particles split and merge
  bool forced_targets = false;    ///< a test gives their targets
  bool gaze_targets = false;      ///< their targets follow the gaze alone
  bool saliency = false;          ///< their targets follow saliency
  bool saliency_parts = false;    ///< an output asks for what saliency is made of
  bool activation = false;        ///< temporal acceleration chooses who is solved
  bool wall_impulse = false;      ///< an output asks what the walls give the water
};

enum class Phase { FrameStart, Substep, Iteration, SubstepEnd, FrameEnd };

/// What a stage sums over neighbours, where another may share the loop (SharedLoop).
enum class SharedTerm { None, SurfaceNormals, Curl, Conduction };

struct Stage {
  const char* name;
  const char* source = "";  ///< paper and equation
  Phase phase;
  /// Empty when nothing calls for the stage; otherwise the reason. A stage of an effect needs none; with one
  /// it runs where both call for it.
  std::string (*called_for)(const Demand&) = nullptr;
  Part part = Part::Solve;
  /// What its change of the water's momentum is counted as; each stage that writes velocities has one.
  Change changes = Change::None;
  EffectKind effect = no_effect;  ///< that alone calls for it
  SharedTerm loop = SharedTerm::None;
  std::size_t place = 0;  ///< among the passes of a schedule, which says so
  // From the function's view, by stage_of:
  ColumnSet reads = {}, writes = {};
  void (*run)(FluidState&) = nullptr;
};

namespace stage_detail {
template <class View>
View view_of(void (*)(FluidState&, View));
}

/// The stage that runs `function`, a void(FluidState&, ColumnView<...>): what the view declares is what the
/// stage declares.
template <auto function>
Stage stage_of(Stage stage) {
  using View = decltype(stage_detail::view_of(function));
  stage.reads = View::reads;
  stage.writes = View::writes;
  stage.run = [](FluidState& state) { function(state, View(state.particles)); };
  return stage;
}

// Reasons that more than one stage has.
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
