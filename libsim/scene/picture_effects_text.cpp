#include "libsim/scene/picture_effects_text.hpp"

#include "stats/base/text.hpp"

namespace sim {

std::string format_picture_effects(const std::vector<PictureEffect>& effects) {
  std::string out;
  for (const PictureEffect& effect : effects) {
    if (effect.strength == 0) continue;
    out += std::string("[[effect]]\nkind = \"") + traits_of(effect.kind).word +
           "\"\nstrength = " + base::shortest(effect.strength) + "\n";
  }
  return out;
}

std::string picture_effects_in_words(const std::vector<PictureEffect>& effects) {
  std::string out;
  for (const PictureEffect& effect : effects) {
    if (effect.strength == 0) continue;
    out += std::string(out.empty() ? "" : "; ") + traits_of(effect.kind).word +
           " strength = " + base::shortest(effect.strength);
  }
  return out;
}

}  // namespace sim
