#pragma once
/// Effects of the picture only. A scene lists them among its effects, and the solver ignores them. Unlisted
/// effects cost nothing: no pass, no target, no shader.

#include <cstddef>
#include <string>
#include <vector>

namespace base {
class TomlTable;
}

namespace sim {

// The registry, one row each: EFFECT(enumerator, word in the scene file, source). A row's pass is
// shaders/WORD.comp, which computes how the effect changes the sunlight on the floor.
#define SIM_PICTURE_EFFECTS(EFFECT)                                                           \
  EFFECT(Shadows, shadows, "Beer-Lambert along sunlight that flat water refracts; obstacles") \
  EFFECT(Caustics, caustics, "sunlight refracted by the water's surface (Snell), area by area")

enum class PictureEffectKind {
#define SIM_ENUMERATOR(Name, ...) Name,
  SIM_PICTURE_EFFECTS(SIM_ENUMERATOR)
#undef SIM_ENUMERATOR
      count
};
inline constexpr std::size_t picture_effect_count = static_cast<std::size_t>(PictureEffectKind::count);

/// One row of the registry SIM_PICTURE_EFFECTS: the properties of a picture effect.
struct PictureEffectTraits {
  const char* word;
  const char* source;
};
const PictureEffectTraits& traits_of(PictureEffectKind kind);

/// A picture effect as listed by a scene.
struct PictureEffect {
  PictureEffectKind kind{};
  double strength = 1;  ///< 0 to 1, share of the effect's full strength; 0 drops the effect
};

/// Strength of the effect; 0 if it is not listed.
float strength_of(const std::vector<PictureEffect>& effects, PictureEffectKind kind);

std::vector<std::string> picture_effect_words();

/// Reads the picture effects among the tables [[effect]] of a scene file. base::Error at file:line:column,
/// for example for an effect that is listed twice or a value out of range.
std::vector<PictureEffect> read_picture_effects(const std::vector<base::TomlTable>& tables);
/// The checks of read_picture_effects() for a scene that was not read from a file; base::Error names the
/// effect.
void check_picture_effects(const std::vector<PictureEffect>& effects);

}  // namespace sim
