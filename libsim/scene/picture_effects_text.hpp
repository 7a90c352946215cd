#pragma once
/// Effects of the picture as text, for bakes and records.

#include <string>
#include <vector>

#include "libsim/scene/picture_effects.hpp"

namespace sim {

/// The tables that read_picture_effects() reads back as the same; of those that are not dropped.
std::string format_picture_effects(const std::vector<PictureEffect>& effects);
/// The same as "shadows strength = 1; caustics strength = 0.5".
std::string picture_effects_in_words(const std::vector<PictureEffect>& effects);

}  // namespace sim
