#include "libstudy/stimulus/bakes/cell_effects.hpp"

#include <algorithm>
#include <set>

#include "libsim/render/temperature_scale.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/scene/picture_effects_text.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace study {

namespace {

using sim::Effect;
using sim::EffectKind;
using sim::PictureEffect;
using sim::PictureEffectKind;

bool lists(const std::vector<Effect>& effects, EffectKind kind) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const Effect& one) { return one.kind == kind && one.coefficient > 0; });
}

bool lists(const std::vector<PictureEffect>& effects, PictureEffectKind kind) {
  return sim::strength_of(effects, kind) > 0;
}

/// Names of all kinds of effects: first effects of the water, then effects of the picture.
std::vector<std::string> all_kinds() {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < sim::effect_count; ++k)
    out.emplace_back(sim::traits_of(static_cast<EffectKind>(k)).word);
  for (const std::string& word : sim::picture_effect_words()) out.push_back(word);
  return out;
}

std::optional<PictureEffectKind> picture_effect_named(const std::string& word) {
  const auto words = sim::picture_effect_words();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) return {};
  return static_cast<PictureEffectKind>(found - words.begin());
}

/// The scene's effect of this kind; base::Error if the scene lists no such effect.
template <class Listed, class Kind>
Listed kept(const base::TomlTable& set, std::size_t place, const std::vector<Listed>& listed, Kind kind,
            const std::string& scene) {
  if (!lists(listed, kind)) {
    set.fail_at(
        "keep", place,
        std::string("= ") + base::toml_quoted(sim::traits_of(kind).word) + " is no effect of scene " + scene +
            " (it is not listed there, or with the value 0)",
        "list it in the scene's file with a value above 0, or write it as [[design.effect_set.effect]]");
  }
  return *std::find_if(listed.begin(), listed.end(), [&](const Listed& one) { return one.kind == kind; });
}

struct Kept {
  std::vector<Effect> water;
  std::vector<PictureEffect> picture;
};

/// Reads the key `keep`: effects that a level takes from the scene file unchanged.
Kept kept_effects(const base::TomlTable& set, const sim::Scene& scene) {
  Kept out;
  const auto words = set.has("keep") ? set.strings("keep") : std::vector<std::string>();
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (const auto of_picture = picture_effect_named(words[i])) {
      out.picture.push_back(kept(set, i, scene.picture_effects, *of_picture, scene.name));
      continue;
    }
    const auto kind = sim::effect_named(words[i]);
    if (!kind) {
      set.fail_at("keep", i, "= " + base::toml_quoted(words[i]) + " is no effect",
                  "use one of " + base::joined(all_kinds()));
    }
    out.water.push_back(kept(set, i, scene.effects, *kind, scene.name));
  }
  return out;
}

/// Keys of a kind of effect: its coefficient and its options.
std::vector<std::string> keys_of(const std::string& word) {
  if (picture_effect_named(word)) return {"strength"};
  const EffectKind kind = *sim::effect_named(word);
  std::vector<std::string> out{sim::traits_of(kind).key};
  for (std::size_t k = 0; k < sim::option_count; ++k) {
    const auto& option = sim::traits_of(static_cast<sim::EffectOption>(k));
    if (option.of == kind) out.emplace_back(option.key);
  }
  return out;
}

/// Refuses keys that a kind of effect does not have.
void check_keys(const base::TomlTable& set) {
  for (const auto& table : set.tables("effect")) {
    const std::string word = table.choice("kind", all_kinds());
    const auto known = keys_of(word);
    for (const std::string& key : table.keys()) {
      if (key == "kind" || std::find(known.begin(), known.end(), key) != known.end()) continue;
      table.fail(key, "is no key of " + word, "use " + base::joined(known));
    }
  }
}

void check_needs(const base::TomlTable& set, const std::vector<Effect>& kept,
                 const std::vector<Effect>& all) {
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const EffectKind needs = sim::traits_of(kept[i].kind).needs;
    if (needs == sim::no_effect || lists(all, needs)) continue;
    const std::string word = sim::traits_of(kept[i].kind).word, other = sim::traits_of(needs).word;
    const auto words = set.strings("keep");  // may also name effects of the picture, which `kept` lacks
    const auto at = std::find(words.begin(), words.end(), word) - words.begin();
    set.fail_at(
        "keep", static_cast<std::size_t>(at),
        "= " + base::toml_quoted(word) + " needs " + other + ", which is missing or has the coefficient 0",
        "keep " + other + " too, or remove this effect");
  }
}

CellEffects read_set(const base::TomlTable& set, const sim::Scene& scene) {
  check_keys(set);
  const Kept kept = kept_effects(set, scene);
  const auto water = sim::read_effects(set.tables("effect"), kept.water);
  check_needs(set, kept.water, water);
  auto picture = sim::read_picture_effects(set.tables("effect"));
  picture.insert(picture.end(), kept.picture.begin(), kept.picture.end());
  return {water, picture};
}

base::TomlTable design_of(const Protocol& protocol) {
  return base::parse_toml(protocol.text, protocol.place).table("design");
}

bool names_picture(const base::TomlTable& set) {
  const auto words = set.has("keep") ? set.strings("keep") : std::vector<std::string>();
  const auto tables = set.tables("effect");
  return std::any_of(words.begin(), words.end(), picture_effect_named) ||
         std::any_of(tables.begin(), tables.end(),
                     [](const auto& table) { return picture_effect_named(table.string("kind")); });
}

/// True if any level names effects of the picture. If not, every level has the picture effects of the scene.
bool varies_picture(const base::TomlTable& design) {
  const auto sets = design.tables("effect_set");
  return std::any_of(sets.begin(), sets.end(), names_picture);
}

std::string effect_words(const CellEffects& effects) {
  std::string words = sim::effects_in_words(*effects.water);
  const std::string picture =
      effects.picture ? sim::picture_effects_in_words(*effects.picture) : std::string();
  if (!picture.empty()) words += (words.empty() ? "" : "; ") + picture;
  return words.empty() ? "no effects" : words;
}

/// Checks that no two levels have the same effects in this scene.
void check_levels(const Protocol& protocol, const sim::Scene& scene) {
  const auto& levels = protocol.design.effects;
  const char* same_as =
      varies_picture(design_of(protocol)) ? " is the same water and light as " : " is the same water as ";
  std::vector<std::string> held;
  for (const EffectSet& level : levels) {
    const CellEffects of = effects_of(protocol, level.name, scene);
    const std::string effects = sim::format_effects(*of.water) +
                                sim::format_picture_effects(of.picture.value_or(scene.picture_effects));
    const auto same = std::find(held.begin(), held.end(), effects);
    if (same != held.end()) {
      const std::string twin = same_as + ("\"" + levels[static_cast<std::size_t>(same - held.begin())].name) +
                               "\" in scene " + scene.name;
      constexpr const char* mend = "remove one of the two, or give them different effects";
      const base::TomlTable design = design_of(protocol);
      if (design.has("effects"))
        design.fail_at("effects", held.size(), "= \"" + level.name + "\"" + twin, mend);
      // In format 3 the levels of factors name the effects.
      base::parse_toml(protocol.text, protocol.place)
          .fail("stimulus", "or a level names effects = \"" + level.name + "\", which" + twin, mend);
    }
    held.push_back(effects);
  }
}

/// One copy of the scene for each level of effects of the design; the scene itself if the design has none.
std::vector<sim::Scene> scenes_of_levels(const Protocol& protocol, const sim::Scene& scene) {
  if (protocol.design.effects.empty()) return {scene};
  std::vector<sim::Scene> out;
  for (const EffectSet& level : protocol.design.effects)
    out.push_back(scene_with(scene, effects_of(protocol, level.name, scene)));
  return out;
}

/// Checks that, with this method, every level has temperatures and paints them in the same colours.
void check_temperatures(const Protocol& protocol, const sim::Scene& scene, sim::MethodKind method) {
  std::vector<sim::TemperatureScale> scales;
  std::vector<bool> idle;
  for (const sim::Scene& of_level : scenes_of_levels(protocol, scene)) {
    scales.emplace_back(sim::acting_scene(of_level, method));
    idle.push_back(!scales.back().heat() && sim::TemperatureScale(of_level).heat());
  }
  const auto& levels = protocol.design.effects;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const sim::TemperatureScale& scale = scales[i];
    const std::string where =
        "scene " + scene.name + (levels.empty() ? "" : " at level \"" + levels[i].name + "\"") +
        (idle[i] ? " in the water of " + sim::method_name(method) + ", by its coarsest_level" : "");
    if (!scale.heat()) {
      design_of(protocol).fail("overlay",
                               "= \"temperature\" needs the effect heat, which is missing in " + where,
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

CellEffects effects_of(const Protocol& protocol, const std::string& level, const sim::Scene& scene) {
  const base::TomlTable design = design_of(protocol);
  CellEffects out{std::vector<Effect>(), std::vector<PictureEffect>()};
  if (level == scene_effects_level) out = {scene.effects, scene.picture_effects};
  if (level != scene_effects_level && level != no_effects_level) {
    for (const auto& set : design.tables("effect_set"))
      if (set.string("name") == level) out = read_set(set, scene);
  }
  const auto by_kind = [](const auto& a, const auto& b) { return a.kind < b.kind; };
  std::sort(out.water->begin(), out.water->end(), by_kind);
  std::sort(out.picture->begin(), out.picture->end(), by_kind);
  if (!varies_picture(design)) out.picture.reset();
  return out;
}

sim::Scene scene_with(sim::Scene scene, const CellEffects& effects) {
  if (effects.water) scene.effects = *effects.water;
  if (effects.picture) scene.picture_effects = *effects.picture;
  return scene;
}

CellEffects cell_effects(const Protocol& protocol, const StimulusSpec& what) {
  if (what.effects.empty()) return {};
  return effects_of(protocol, what.effects, sim::read_scene(base::find_input(what.scene)));
}

void check_cell_effects(const Protocol& protocol) {
  if (protocol.design.effects.empty() && !protocol.design.paint_temperature) return;
  std::set<std::pair<std::string, std::string>> waters;
  for (const Cell& cell : protocol.design.cells) {
    if (!waters.emplace(cell.stimulus.scene, cell.stimulus.method).second) continue;
    const sim::Scene scene = sim::read_scene(base::find_input(cell.stimulus.scene));
    check_levels(protocol, scene);
    if (protocol.design.paint_temperature)
      check_temperatures(protocol, scene, sim::parse_method(cell.stimulus.method));
  }
}

std::string temperatures_in_words(const Protocol& protocol, const sim::Scene& scene) {
  return sim::TemperatureScale(scenes_of_levels(protocol, scene).front()).words();
}

std::string levels_in_words(const Protocol& protocol, const sim::Scene& scene) {
  std::string out;
  for (const EffectSet& level : protocol.design.effects) {
    out +=
        (out.empty() ? "" : ", ") + level.name + ": " + effect_words(effects_of(protocol, level.name, scene));
  }
  return out;
}

}  // namespace study
