#pragma once
/// Runs the variants of each effect's levels of detail side by side.

#include "apps/bench/effects_levels.hpp"
#include "apps/common/picture_size.hpp"
#include "libsim/simulation.hpp"

namespace apps {

struct LevelRuns {
  sim::SimulationOptions choice;
  int warm_up = 0, frames = 1;
  PictureSize size;
};

/// All variants start from one settled state, look at the scene's gaze point, step in turn with each pass
/// timed, and are drawn at four instants, the last of which is the last frame. base::Error for a method with
/// one level.
std::vector<LevelCost> run_levels(const std::vector<LevelVariant>& variants, const LevelRuns& runs);

}  // namespace apps
