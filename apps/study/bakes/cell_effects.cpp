#include "apps/study/bakes/cell_effects.hpp"

#include <algorithm>
#include <set>

#include "apps/common/temperature_scale.hpp"
#include "libsim/scene/picture_effects.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace apps {

namespace {

using sim::Effect;
using sim::EffectKind;

bool lists(const std::vector<Effect>& effects, EffectKind kind) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const Effect& one) { return one.kind == kind && one.coefficient > 0; });
}

std::vector<std::string> all_kinds() {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < sim::effect_count; ++k)
    out.emplace_back(sim::traits_of(static_cast<EffectKind>(k)).word);
  return out;
}

bool is_of_the_picture(const std::string& word) {
  const auto words = sim::picture_effect_words();
  return std::find(words.begin(), words.end(), word) != words.end();
}

constexpr const char* stays = "is an effect of the picture, which every level keeps";
constexpr const char* leave_out = "leave it out";

/// keep: kinds that stay as the scene lists them.
std::vector<Effect> kept_effects(const base::TomlTable& set, const sim::Scene& scene) {
  std::vector<Effect> out;
  const auto words = set.has("keep") ? set.strings("keep") : std::vector<std::string>();
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = "= " + base::toml_quoted(words[i]);
    if (is_of_the_picture(words[i])) set.fail_at("keep", i, word + " " + stays, leave_out);
    const auto kind = sim::effect_named(words[i]);
    if (!kind) set.fail_at("keep", i, word + " is no effect", "use one of " + base::joined(all_kinds()));
    if (!lists(scene.effects, *kind)) {
      set.fail_at("keep", i, word + " is no effect of scene " + scene.name,
                  "list it there, or give it here as [[design.effect_set.effect]]");
    }
    out.push_back(*std::find_if(scene.effects.begin(), scene.effects.end(),
                                [&](const Effect& one) { return one.kind == *kind; }));
  }
  return out;
}

/// Keys that a kind of effect lacks.
void check_keys(const base::TomlTable& set) {
  for (const auto& table : set.tables("effect")) {
    if (const std::string word = table.string("kind"); is_of_the_picture(word))
      table.fail("kind", "= " + base::toml_quoted(word) + " " + stays, leave_out);
    const auto kind = sim::effect_named(table.choice("kind", all_kinds()));
    std::vector<std::string> known{sim::traits_of(*kind).key};
    for (std::size_t k = 0; k < sim::option_count; ++k) {
      const auto& option = sim::traits_of(static_cast<sim::EffectOption>(k));
      if (option.of == *kind) known.emplace_back(option.key);
    }
    for (const std::string& key : table.keys()) {
      if (key == "kind" || std::find(known.begin(), known.end(), key) != known.end()) continue;
      table.fail(key, std::string("is no key of ") + sim::traits_of(*kind).word,
                 "use " + base::joined(known));
    }
  }
}

void check_needs(const base::TomlTable& set, const std::vector<Effect>& kept,
                 const std::vector<Effect>& all) {
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const EffectKind needs = sim::traits_of(kept[i].kind).needs;
    if (needs == sim::no_effect || lists(all, needs)) continue;
    const std::string other = sim::traits_of(needs).word;
    set.fail_at("keep", i, "needs " + other + ", of which there is none",
                "keep " + other + " too, or leave it out");
  }
}

std::vector<Effect> read_set(const base::TomlTable& set, const sim::Scene& scene) {
  check_keys(set);
  const auto kept = kept_effects(set, scene);
  const auto all = sim::read_effects(set.tables("effect"), kept);
  check_needs(set, kept, all);
  return all;
}

base::TomlTable design_of(const study::Protocol& protocol) {
  return base::parse_toml(protocol.text, protocol.place).table("design");
}

std::string words_of(const std::vector<Effect>& effects) {
  const std::string words = sim::effects_in_words(effects);
  return words.empty() ? "no effects" : words;
}

/// No two levels are the same water.
void check_levels(const study::Protocol& protocol, const sim::Scene& scene) {
  const auto& levels = protocol.design.effects;
  std::vector<std::string> held;
  for (const study::EffectSet& level : levels) {
    const std::string effects = sim::format_effects(effects_of(protocol, level.name, scene));
    const auto same = std::find(held.begin(), held.end(), effects);
    if (same != held.end()) {
      design_of(protocol).fail_at("effects", held.size(),
                                  "= \"" + level.name + "\" is the same water as \"" +
                                      levels[static_cast<std::size_t>(same - held.begin())].name +
                                      "\" in scene " + scene.name,
                                  "remove one of the two, or give them different effects");
    }
    held.push_back(effects);
  }
}

/// Of the water of each level, or of the scene's own.
std::vector<TemperatureScale> scales_of(const study::Protocol& protocol, const sim::Scene& scene) {
  if (protocol.design.effects.empty()) return {TemperatureScale(scene)};
  std::vector<TemperatureScale> out;
  for (const study::EffectSet& level : protocol.design.effects) {
    sim::Scene held = scene;
    held.effects = effects_of(protocol, level.name, scene);
    out.emplace_back(held);
  }
  return out;
}

/// All that is compared has temperatures, in the same colours.
void check_temperatures(const study::Protocol& protocol, const sim::Scene& scene) {
  const auto scales = scales_of(protocol, scene);
  const auto& levels = protocol.design.effects;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const TemperatureScale& scale = scales[i];
    const std::string where =
        "scene " + scene.name + (levels.empty() ? "" : " at level \"" + levels[i].name + "\"");
    if (!scale.heat()) {
      design_of(protocol).fail("overlay", "= \"temperature\" finds no heat in " + where,
                               "give it the effect heat, or remove the overlay");
    }
    if (scales.front().same_colours(scale)) continue;
    design_of(protocol).fail("overlay",
                             "= \"temperature\" has other colours in " + where + ", " + scale.words() +
                                 ", than at level \"" + levels.front().name + "\", " + scales.front().words(),
                             "name the same temperatures at every level");
  }
}

}  // namespace

std::vector<Effect> effects_of(const study::Protocol& protocol, const std::string& level,
                               const sim::Scene& scene) {
  std::vector<Effect> out;
  if (level == study::scene_effects_level) out = scene.effects;
  if (level != study::scene_effects_level && level != study::no_effects_level) {
    for (const auto& set : design_of(protocol).tables("effect_set"))
      if (set.string("name") == level) out = read_set(set, scene);
  }
  std::sort(out.begin(), out.end(), [](const Effect& a, const Effect& b) { return a.kind < b.kind; });
  return out;
}

std::optional<std::vector<Effect>> cell_effects(const study::Protocol& protocol,
                                                const study::StimulusSpec& what) {
  if (what.effects.empty()) return {};
  return effects_of(protocol, what.effects, sim::read_scene(base::find_input(what.scene)));
}

void check_cell_effects(const study::Protocol& protocol) {
  if (protocol.design.effects.empty() && !protocol.design.paint_temperature) return;
  std::set<std::string> scenes;
  for (const study::Cell& cell : protocol.design.cells) {
    if (!scenes.insert(cell.stimulus.scene).second) continue;
    const sim::Scene scene = sim::read_scene(base::find_input(cell.stimulus.scene));
    check_levels(protocol, scene);
    if (protocol.design.paint_temperature) check_temperatures(protocol, scene);
  }
}

std::string temperatures_in_words(const study::Protocol& protocol, const sim::Scene& scene) {
  return scales_of(protocol, scene).front().words();
}

std::string levels_in_words(const study::Protocol& protocol, const sim::Scene& scene) {
  std::string out;
  for (const study::EffectSet& level : protocol.design.effects) {
    out += (out.empty() ? "" : ", ") + level.name + ": " + words_of(effects_of(protocol, level.name, scene));
  }
  return out;
}

}  // namespace apps
