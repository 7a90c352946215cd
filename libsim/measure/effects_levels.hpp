#pragma once
/// Savings and visible changes of an effect's own level of detail, as runs, a table and a picture.

#include <string>
#include <vector>

#include "libsim/measure/effects_cost.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

/// One effect with those it needs, limited to levels up to a coarsest one.
struct LevelVariant {
  std::string effect;  ///< its word
  std::string levels;  ///< "none", "0 to 3", "0 to 2", ..., "0", or "0 to 3, start moved"
  sim::EffectKind kind{};
  sim::Scene scene;
  bool moved = false;  ///< every coordinate of the start is perturbed by an ulp
};
/// For each effect that has a coarsest level, in this order: without it, at all levels, with each lower
/// coarsest level, and at all levels from a perturbed start. base::Error if the scene lists no such effect
/// with a coefficient above 0.
std::vector<LevelVariant> level_variants_of(const sim::Scene& scene);

/// Cost of a variant, and difference of its pictures from those of the effect at all levels.
struct LevelCost {
  std::string effect, levels;
  double particles = 0;  ///< mean over frames
  double ms_frame = 0;   ///< median
  double ms_passes = 0;  ///< median of the effect's own passes
  /// Over all pictures; PSNR is infinite if they are equal.
  double psnr_db = 0, ssim = 0, flip_percent = 0;
};

struct LevelRuns {
  sim::SimulationOptions choice;
  int warm_up = 0, frames = 1;
  base::PictureSize size;
};

/// All variants start from one settled state, look at the scene's gaze point, step in turn with each pass
/// timed, and are drawn at four instants, the last of which is the last frame. base::Error for a method with
/// one level.
std::vector<LevelCost> run_levels(const std::vector<LevelVariant>& variants, const LevelRuns& runs);

/// One row per variant, each effect's rows together: the added time is relative to the first row, the saved
/// time is a share of the effect's own passes in the second row.
figures::TextTable to_table(const EffectsRun& run, const std::vector<LevelCost>& costs);
/// One bar per variant: ms of the effect's own passes.
std::string to_svg(const EffectsRun& run, const std::vector<LevelCost>& costs);

}  // namespace measure
