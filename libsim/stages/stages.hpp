#pragma once
/// The stages of the solver, one source file each. A stage is data: what it is called, which columns it reads
/// and writes, when a schedule needs it, and the function that launches it.

#include <string>
#include <vector>

#include "libsim/stages/fluid_state.hpp"

namespace sim::SIM_BACKEND {

/// What a scene, a method and the wanted outputs call for.
struct Demand {
  SolverParameters parameters;
  bool nozzles = false;     ///< the scene has one
  bool settling = false;    ///< the gate is closed and the water comes to rest
  bool levels = false;      ///< particles split and merge
  bool saliency = false;    ///< their targets follow saliency
  bool activation = false;  ///< temporal acceleration chooses who is solved
};

enum class Phase { FrameStart, Substep, Iteration, SubstepEnd, FrameEnd };

struct Stage {
  const char* name;
  const char* source;  ///< paper and equation
  Phase phase;
  ColumnSet reads, writes;
  /// Empty when nothing calls for the stage; otherwise the reason.
  std::string (*called_for)(const Demand&);
  void (*run)(FluidState&);
};

/// Moves the lowest water of the corner columns into the jets.
Stage nozzle_stage();
/// Gravity and the explicit step to predicted positions; speed limit; quarantine of what is not finite.
Stage predict_stage();
/// Grid and combined neighbour list at the predicted positions.
Stage neighbours_stage();
/// The slow part of the pressure, solved on cells and applied first.
Stage coarse_pressure_stage();
/// Density, unilateral constraint and its multiplier lambda.
Stage density_stage();
/// Position correction, momentum-exact, and wall projection.
Stage displacement_stage();
/// Velocity from the positions.
Stage velocity_stage();
/// XSPH viscosity.
Stage xsph_stage();
/// Velocity x 0.9 a frame while the water settles.
Stage settling_stage();

/// All stages in the fixed order in which a schedule may call them.
std::vector<Stage> all_stages();

}  // namespace sim::SIM_BACKEND
