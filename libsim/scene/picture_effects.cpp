#include "libsim/scene/picture_effects.hpp"

#include <algorithm>
#include <array>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

constexpr std::array<PictureEffectTraits, picture_effect_count> picture_traits{{
#define SIM_TRAITS(Name, word, source) {#word, source},
    SIM_PICTURE_EFFECTS(SIM_TRAITS)
#undef SIM_TRAITS
}};

const PictureEffect* find(const std::vector<PictureEffect>& effects, PictureEffectKind kind) {
  const auto found = std::find_if(effects.begin(), effects.end(),
                                  [&](const PictureEffect& effect) { return effect.kind == kind; });
  return found == effects.end() ? nullptr : &*found;
}

}  // namespace

const PictureEffectTraits& traits_of(PictureEffectKind kind) {
  return picture_traits[static_cast<std::size_t>(kind)];
}

float strength_of(const std::vector<PictureEffect>& effects, PictureEffectKind kind) {
  const PictureEffect* effect = find(effects, kind);
  return effect ? static_cast<float>(effect->strength) : 0;
}

std::vector<std::string> picture_effect_words() {
  std::vector<std::string> out;
  for (const PictureEffectTraits& traits : picture_traits) out.emplace_back(traits.word);
  return out;
}

std::vector<PictureEffect> read_picture_effects(const std::vector<base::TomlTable>& tables) {
  const auto words = picture_effect_words();
  std::vector<PictureEffect> out;
  for (const auto& table : tables) {
    const auto word = std::find(words.begin(), words.end(), table.string("kind"));
    if (word == words.end()) continue;
    const auto kind = static_cast<PictureEffectKind>(word - words.begin());
    if (find(out, kind)) table.fail("kind", "is listed twice", "keep one of the two");
    out.push_back({kind, table.number_or("strength", 1, {0, 1})});
  }
  return out;
}

void check_picture_effects(const std::vector<PictureEffect>& effects) {
  for (const PictureEffect& effect : effects) {
    const auto fail = [&](const std::string& problem, const char* mend) {
      throw base::Error(std::string("effect ") + traits_of(effect.kind).word, problem, mend);
    };
    if (find(effects, effect.kind) != &effect) fail("is listed twice", "keep one of the two");
    if (!(effect.strength >= 0 && effect.strength <= 1))
      fail("strength = " + base::shortest(effect.strength) + " is out of range", "use 0 to 1");
  }
}

}  // namespace sim
