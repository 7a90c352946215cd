#pragma once
/// What an effect's own level of detail saves, and what it changes in the picture: as runs, a table and a
/// picture.

#include <string>
#include <vector>

#include "apps/bench/effects_cost.hpp"
#include "libsim/scene/scene.hpp"

namespace apps {

/// One effect, with what it needs, kept to levels up to its coarsest.
struct LevelVariant {
  std::string effect;  ///< its word
  std::string levels;  ///< "none", "0 to 3", "0 to 2", ..., "0", or "0 to 3, start moved"
  sim::EffectKind kind{};
  sim::Scene scene;
  bool moved = false;  ///< every coordinate of the start lies an ulp away
};
/// For each effect that has a coarsest level: without it, at all levels, each coarsest level below, and all
/// levels from a moved start, in this order. base::Error where the scene lists no such effect with a
/// coefficient above 0.
std::vector<LevelVariant> level_variants_of(const sim::Scene& scene);

/// What a variant took and how far its pictures are from those of the effect at all levels.
struct LevelCost {
  std::string effect, levels;
  double particles = 0;  ///< mean over frames
  double ms_frame = 0;   ///< median
  double ms_passes = 0;  ///< of the effect's own passes; median
  /// Over all pictures; PSNR is infinite where they are equal.
  double psnr_db = 0, ssim = 0, flip_percent = 0;
};

/// A row a variant, each effect's rows together: added is over the first of them, saved is of the time of the
/// second one's own passes.
TextTable to_table(const EffectsRun& run, const std::vector<LevelCost>& costs);
/// A bar a variant: ms of the effect's own passes.
std::string to_svg(const EffectsRun& run, const std::vector<LevelCost>& costs);

}  // namespace apps
