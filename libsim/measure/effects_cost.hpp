#pragma once
/// Cost of a scene's effects compared with the scene without effects, as numbers, a table and a picture.

#include <limits>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "stats/figures/text_table.hpp"

namespace measure {

/// A scene with some of its effects.
struct EffectVariant {
  std::string name;  ///< "none", an effect's word with those it needs, "all", "all at 0"
  sim::Scene scene;
};
/// The effect and, before it, the scene's effects that it needs.
std::vector<sim::Effect> with_needs(const std::vector<sim::Effect>& all, const sim::Effect& effect);
/// The scene without effects, with each effect and those that it needs, with all effects (unless an earlier
/// entry has them all), and with the coefficients of all effects at 0, in this order. base::Error if the
/// scene lists none with a coefficient above 0.
std::vector<EffectVariant> variants_of(const sim::Scene& scene);

/// Measurements of one variant. Means are over frames.
struct EffectCost {
  std::string name;
  double particles = 0;
  double ms_frame = 0;
  double launches = 0;  ///< per frame
  /// Bytes of all particle columns and of the data of saliency, temporal acceleration, nozzles, outlets,
  /// foam.
  double column_bytes = 0;
  /// Bytes of device memory beyond those in use before this fluid was made; NaN on the CPU.
  double device_bytes = std::numeric_limits<double>::quiet_NaN();
  bool same_state = false;  ///< all particles equal those of the scene without effects, bit for bit
};

/// Labels of the run, for the table's rows and the picture's title.
struct EffectsRun {
  std::string scene, method, backend, n_star;
  int frames = 0, substeps = 0;
};
/// One row per variant; added costs are relative to the first row, without effects.
figures::TextTable to_table(const EffectsRun& run, const std::vector<EffectCost>& costs);
/// One bar per variant: ms per frame.
std::string to_svg(const EffectsRun& run, const std::vector<EffectCost>& costs);

}  // namespace measure
