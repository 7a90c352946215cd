#pragma once
/// Converts the levels of a protocol's factor effects to effects of a scene.

#include <optional>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// Effects of a cell that replace those of its scene file, by kind.
struct CellEffects {
  std::optional<std::vector<sim::Effect>> water = {};  ///< none: the design does not vary effects
  std::optional<std::vector<sim::PictureEffect>> picture =
      {};  ///< none: no level names one; the scene's remain
};

/// Effects of a level in this scene; `water` is always set. base::Error at file:line:column of the protocol:
/// an unknown kind, one that the scene does not list (keep), one that needs another, an unknown key, a number
/// out of range.
CellEffects effects_of(const Protocol& protocol, const std::string& level, const sim::Scene& scene);

/// The scene with its effects replaced by these.
sim::Scene scene_with(sim::Scene scene, const CellEffects& effects);

/// Effects of one cell; reads its scene file.
CellEffects cell_effects(const Protocol& protocol, const StimulusSpec& what);

/// base::Error for errors of any level in any scene, and for two levels that look the same in a scene. If
/// temperature is painted, also for a cell without heat, and for two levels that would paint one temperature
/// in two colours.
void check_cell_effects(const Protocol& protocol);

/// "none: no effects; foam: foam emission_per_s = 0.3 ...": each level in this scene; empty without the
/// factor.
std::string levels_in_words(const Protocol& protocol, const sim::Scene& scene);

/// "temperature 293.15 to 353.15 K": the painted range in this scene, at every level.
std::string temperatures_in_words(const Protocol& protocol, const sim::Scene& scene);

}  // namespace study
