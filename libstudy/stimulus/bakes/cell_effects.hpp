#pragma once
/// Converts the levels of a protocol's factor effects to effects of a scene.

#include <optional>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace study {

/// Effects of a cell that replace the effects of its scene file.
struct CellEffects {
  std::optional<std::vector<sim::Effect>> water = {};  ///< none: the design does not vary effects
  /// None: the picture keeps the effects of the scene, because no level names an effect of the picture.
  std::optional<std::vector<sim::PictureEffect>> picture = {};
};

/// Effects of a level in this scene; `water` is always set. base::Error at file:line:column of the protocol:
/// an unknown kind, a kind in keep that the scene does not list, an effect without the effect that it needs,
/// an unknown key, a number out of range.
CellEffects effects_of(const Protocol& protocol, const std::string& level, const sim::Scene& scene);

/// A copy of the scene with these effects instead of the scene's effects.
sim::Scene scene_with(sim::Scene scene, const CellEffects& effects);

/// Effects of one stimulus; reads its scene file.
CellEffects cell_effects(const Protocol& protocol, const StimulusSpec& what);

/// base::Error for errors of any level in any scene, and for two levels with the same effects in a scene. If
/// temperatures are painted, also for a cell without heat, and for two levels that would paint the same
/// temperature in different colours.
void check_cell_effects(const Protocol& protocol);

/// "none: no effects; foam: foam emission_per_s = 0.3 ...": the effects of each level in this scene; empty if
/// the design does not vary effects.
std::string levels_in_words(const Protocol& protocol, const sim::Scene& scene);

/// The painted range of temperatures in this scene at the first level of effects, such as "temperature 293.15
/// to 353.15 K". check_cell_effects() requires the same range at every level.
std::string temperatures_in_words(const Protocol& protocol, const sim::Scene& scene);

}  // namespace study
