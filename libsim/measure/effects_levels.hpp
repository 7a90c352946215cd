#pragma once
/// Savings and visible changes of an effect's own level of detail, as runs, a table and a picture.

#include <string>
#include <vector>

#include "libsim/measure/effects_cost.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

/// A scene with one effect and those it needs, which act only on water up to a coarsest level.
struct LevelVariant {
  std::string effect;  ///< the effect's word in scene files
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
  /// Differences over all pictures; PSNR is infinite if the pictures are equal.
  double psnr_db = 0, ssim = 0, flip_percent = 0;
};

struct LevelRuns {
  sim::SimulationOptions choice;
  int warm_up = 0, frames = 1;
  base::PictureSize size;
};

/// All variants start from one settled state (perturbed if LevelVariant::moved), with the gaze on the scene's
/// gaze point. In each frame they step one after the other, with each pass timed. Their pictures are compared
/// at four equally spaced frames up to the last one. base::Error for a method with one level.
std::vector<LevelCost> run_levels(const std::vector<LevelVariant>& variants, const LevelRuns& runs);

/// One row per variant, grouped by effect. The added time is relative to the group's first row, without the
/// effect; the saved time is a share of the effect's own passes in the group's second row, at all levels.
figures::TextTable to_table(const EffectsRun& run, const std::vector<LevelCost>& costs);
/// One bar per variant, except those without the effect: ms of the effect's own passes.
std::string to_svg(const EffectsRun& run, const std::vector<LevelCost>& costs);

}  // namespace measure
