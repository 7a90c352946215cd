#pragma once
/// What a scene's effects cost over the bare scene, as numbers, a table and a picture.

#include <limits>
#include <string>
#include <vector>

#include "apps/common/text_table.hpp"
#include "libsim/scene/scene.hpp"

namespace apps {

/// A scene with some of its effects.
struct EffectVariant {
  std::string name;  ///< "none", an effect's word with what it needs, "all", "all at 0"
  sim::Scene scene;
};
/// One of a scene's effects, the last, behind those of them that it needs.
std::vector<sim::Effect> with_needs(const std::vector<sim::Effect>& all, const sim::Effect& effect);
/// The bare scene first, each effect alone, then all of them (unless one needs all others) and all at 0.
/// base::Error where the scene lists none with a coefficient above 0.
std::vector<EffectVariant> variants_of(const sim::Scene& scene);

/// What a variant took. Means are over frames.
struct EffectCost {
  std::string name;
  double particles = 0;
  double ms_frame = 0;
  double launches = 0;  ///< a frame
  /// Of all columns and what saliency, temporal acceleration, nozzles, outlets and foam keep.
  double column_bytes = 0;
  /// Of the device's memory above what it held before this fluid was made; NaN on the CPU.
  double device_bytes = std::numeric_limits<double>::quiet_NaN();
  bool same_state = false;  ///< places and velocities of all particles are the bare scene's, bit for bit
};

/// What ran, as it stands before each row and over the picture.
struct EffectsRun {
  std::string scene, method, backend, n_star;
  int frames = 0, substeps = 0;
};
/// A row a variant; what is added is over the first row, the bare scene.
TextTable to_table(const EffectsRun& run, const std::vector<EffectCost>& costs);
/// A bar a variant: ms a frame.
std::string to_svg(const EffectsRun& run, const std::vector<EffectCost>& costs);

}  // namespace apps
