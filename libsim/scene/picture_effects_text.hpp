#pragma once
/// Picture effects as text, for bakes and records.

#include <string>
#include <vector>

#include "libsim/scene/picture_effects.hpp"

namespace sim {

/// Writes tables that read_picture_effects() reads back as the same effects; omits effects with the strength
/// 0.
std::string format_picture_effects(const std::vector<PictureEffect>& effects);
/// The effects in one line, in the form "shadows strength = 1; caustics strength = 0.5".
std::string picture_effects_in_words(const std::vector<PictureEffect>& effects);

}  // namespace sim
