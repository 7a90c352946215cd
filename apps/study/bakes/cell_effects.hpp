#pragma once
/// The levels of a protocol's factor effects as effects of a scene.

#include <optional>
#include <string>
#include <vector>

#include "libsim/scene/scene.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// What a cell has instead of what its scene's file lists, by kind.
struct CellEffects {
  std::optional<std::vector<sim::Effect>> water = {};  ///< none: the design does not vary effects
  std::optional<std::vector<sim::PictureEffect>> picture =
      {};  ///< none: no level names one; the scene's stay
};

/// Effects of a level in this scene; those of the water are always given. base::Error at file:line:column of
/// the protocol: an unknown kind, one that the scene does not list (keep), one that needs another, an unknown
/// key, a number out of range.
CellEffects effects_of(const study::Protocol& protocol, const std::string& level, const sim::Scene& scene);

/// The scene with these instead.
sim::Scene scene_with(sim::Scene scene, const CellEffects& effects);

/// Effects of one cell; reads its scene file.
CellEffects cell_effects(const study::Protocol& protocol, const study::StimulusSpec& what);

/// The errors of every level in every scene, and two levels that look the same in one. Where temperature
/// is painted: a cell without heat, and two levels that would paint one temperature in two colours.
void check_cell_effects(const study::Protocol& protocol);

/// "none: no effects; foam: foam emission_per_s = 0.3 ...": each level in this scene; empty without the
/// factor.
std::string levels_in_words(const study::Protocol& protocol, const sim::Scene& scene);

/// "temperature 293.15 to 353.15 K": what is painted in this scene, at every level.
std::string temperatures_in_words(const study::Protocol& protocol, const sim::Scene& scene);

}  // namespace apps
