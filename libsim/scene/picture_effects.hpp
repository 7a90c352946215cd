#pragma once
/// Effects of the picture alone. A scene lists them among its effects, and the solver does not know of them.
/// What a scene does not list costs nothing: no pass, no target, no shader.

#include <cstddef>
#include <string>
#include <vector>

namespace base {
class TomlTable;
}

namespace sim {

// The registry, a row each: EFFECT(enumerator, the scene file's word, source). A row's pass is
// shaders/WORD.comp, which leaves what the floor of the room is lit by.
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

/// A row of the registry.
struct PictureEffectTraits {
  const char* word;
  const char* source;
};
const PictureEffectTraits& traits_of(PictureEffectKind kind);

/// A picture effect as a scene lists it.
struct PictureEffect {
  PictureEffectKind kind{};
  double strength = 1;  ///< 0 to 1, the share of what the source says; 0 drops the effect
};

/// 0 where it is not listed.
float strength_of(const std::vector<PictureEffect>& effects, PictureEffectKind kind);

std::vector<std::string> picture_effect_words();

/// Those of the tables [[effect]] of a scene file whose kind is a picture effect's. Errors are base::Error at
/// file:line:column: listed twice, out of range.
std::vector<PictureEffect> read_picture_effects(const std::vector<base::TomlTable>& tables);
/// The same of a scene that no file described; base::Error names the effect.
void check_picture_effects(const std::vector<PictureEffect>& effects);

}  // namespace sim
