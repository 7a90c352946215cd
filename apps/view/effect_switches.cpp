#include "apps/view/effect_switches.hpp"

#include <algorithm>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

const sim::Effect* find(const std::vector<sim::Effect>& effects, sim::EffectKind kind) {
  const auto found =
      std::find_if(effects.begin(), effects.end(), [&](const auto& effect) { return effect.kind == kind; });
  return found == effects.end() ? nullptr : &*found;
}

std::vector<std::string> words_of(const std::vector<sim::Effect>& effects) {
  std::vector<std::string> out;
  for (const auto& effect : effects) out.emplace_back(sim::traits_of(effect.kind).word);
  return out;
}

}  // namespace

std::vector<EffectSwitch> switches_of(const std::vector<sim::Effect>& listed,
                                      const std::vector<sim::Effect>& running) {
  std::vector<EffectSwitch> out;
  for (const auto& effect : listed) {
    const sim::Effect* now = find(running, effect.kind);
    out.push_back({now ? *now : effect, 4 * effect.coefficient, now && now->coefficient > 0});
  }
  return out;
}

std::vector<sim::Effect> turned_on(const std::vector<EffectSwitch>& switches) {
  std::vector<sim::Effect> out;
  for (const auto& one : switches)
    if (one.on && one.effect.coefficient > 0) out.push_back(one.effect);
  const auto lacks = [&](const sim::Effect& effect) {
    const auto needs = sim::traits_of(effect.kind).needs;
    return needs != sim::no_effect && !find(out, needs);
  };
  // Repeats, because an effect may need an effect that was just removed.
  for (auto at = out.begin(); (at = std::find_if(out.begin(), out.end(), lacks)) != out.end();) out.erase(at);
  return out;
}

void drop_what_cannot_run(std::vector<EffectSwitch>& switches) {
  const auto running = turned_on(switches);
  for (auto& one : switches) one.on = one.on && find(running, one.effect.kind);
}

std::vector<sim::Effect> left_on(const std::vector<sim::Effect>& listed, const std::string& off) {
  if (off.empty()) return listed;
  auto switches = switches_of(listed, listed);
  // The added comma ends the last word. A comma at the end of `off` gives an empty word, which is refused.
  for (const std::string& word : base::split(off + ",")) {
    const auto is_it = [&](const auto& one) { return word == sim::traits_of(one.effect.kind).word; };
    const auto found = std::find_if(switches.begin(), switches.end(), is_it);
    if (found == switches.end()) {
      throw base::Error("--effects-off " + word, "is not an effect that the scene lists",
                        listed.empty() ? "leave the option out" : "write for example " + words_of(listed)[0]);
    }
    found->on = false;
  }
  return turned_on(switches);
}

std::string in_words(const std::vector<sim::Effect>& effects) {
  return effects.empty() ? "no effects" : base::joined(words_of(effects));
}

}  // namespace apps
