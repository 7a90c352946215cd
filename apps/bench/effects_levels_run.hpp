#pragma once
/// Runs each effect's levels of detail beside each other.

#include "apps/bench/effects_levels.hpp"
#include "apps/common/picture_size.hpp"
#include "libsim/simulation.hpp"

namespace apps {

struct LevelRuns {
  sim::SimulationOptions choice;
  int warm_up = 0, frames = 1;
  PictureSize size;
};

/// All variants start from one settled water, look at the scene's gaze point, step in turn with the clock
/// round each pass on, and are drawn at four instants that end with the last frame. base::Error for a method
/// of one level.
std::vector<LevelCost> run_levels(const std::vector<LevelVariant>& variants, const LevelRuns& runs);

}  // namespace apps
