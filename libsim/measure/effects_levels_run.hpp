#pragma once
/// Runs the variants of each effect's levels of detail side by side.

#include "libsim/measure/effects_levels.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

struct LevelRuns {
  sim::SimulationOptions choice;
  int warm_up = 0, frames = 1;
  base::PictureSize size;
};

/// All variants start from one settled state, look at the scene's gaze point, step in turn with each pass
/// timed, and are drawn at four instants, the last of which is the last frame. base::Error for a method with
/// one level.
std::vector<LevelCost> run_levels(const std::vector<LevelVariant>& variants, const LevelRuns& runs);

}  // namespace measure
