/// Reads the factor effects: its levels and their content.
#include <algorithm>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::size_t most_levels = 20;

bool needs_no_table(const std::string& level) {
  return level == no_effects_level || level == scene_effects_level;
}

std::vector<std::string> read_levels(const base::TomlTable& design) {
  const auto levels = distinct_words(design, "effects");
  if (levels.size() < 2) {
    design.fail("effects", "holds one level, and a factor needs at least two",
                "name two levels or more, or list these effects in the scene's file and remove this key");
  }
  if (levels.size() > most_levels) {
    design.fail("effects", "holds " + std::to_string(levels.size()) + " levels",
                "name at most " + std::to_string(most_levels));
  }
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!is_id(levels[i])) {
      design.fail_at("effects", i, "= " + base::toml_quoted(levels[i]) + " is no id",
                     "write a letter, then letters, digits and '_', 64 at most");
    }
  }
  return levels;
}

/// An effect's table as in a scene file, as words: "foam emission_per_s = 0.3". libsim checks its keys.
std::string read_effect(const base::TomlTable& table, const std::string& kind) {
  std::string words = kind;
  for (const std::string& key : table.keys()) {
    if (key != "kind") words += " " + key + " = " + base::shortest(table.number(key, base::non_negative));
  }
  return words;
}

EffectSet read_set(const base::TomlTable& table, const std::string& name) {
  std::vector<std::string> kinds;
  EffectSet set{name, {}};
  if (table.has("keep")) kinds = distinct_words(table, "keep");
  if (!kinds.empty()) set.words = "keeps " + base::joined(kinds);
  for (const auto& effect : table.tables("effect")) {
    const std::string kind = text_of(effect, "kind");
    if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) {
      effect.fail("kind", "= " + base::toml_quoted(kind) + " is in this set twice",
                  "name the kind once: in keep, or in one [[design.effect_set.effect]]");
    }
    kinds.push_back(kind);
    set.words += (set.words.empty() ? "" : "; ") + read_effect(effect, kind);
  }
  if (kinds.empty())
    table.fail("name", "holds no effect",
               "write keep or [[design.effect_set.effect]], or use level \"none\"");
  return set;
}

/// Reads [[design.effect_set]]; `effects` must name each.
std::vector<EffectSet> read_tables(const base::TomlTable& design, const std::vector<std::string>& levels) {
  std::vector<EffectSet> out;
  for (const auto& table : design.tables("effect_set")) {
    const std::string name = text_of(table, "name");
    if (needs_no_table(name)) {
      table.fail("name", "= " + base::toml_quoted(name) + " is a level that needs no table",
                 "use another name, or remove the table");
    }
    if (std::find(levels.begin(), levels.end(), name) == levels.end()) {
      table.fail("name", "= " + base::toml_quoted(name) + " is no level",
                 "use a word that design.effects lists, or remove this table");
    }
    if (std::any_of(out.begin(), out.end(), [&](const EffectSet& one) { return one.name == name; }))
      table.fail("name", "= " + base::toml_quoted(name) + " has a table already", "keep one of the two");
    out.push_back(read_set(table, name));
  }
  return out;
}

}  // namespace

std::vector<EffectSet> read_effect_sets(const base::TomlTable& design) {
  if (!design.has("effects")) {
    if (design.has("effect_set"))
      design.fail("effect_set", "has no effect without the key effects",
                  "write effects = [...] with its name");
    return {};
  }
  const auto levels = read_levels(design);
  const auto tables = read_tables(design, levels);
  std::vector<EffectSet> out;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto found = std::find_if(tables.begin(), tables.end(),
                                    [&](const EffectSet& one) { return one.name == levels[i]; });
    if (found != tables.end()) {
      out.push_back(*found);
    } else if (levels[i] == no_effects_level) {
      out.push_back({levels[i], "no effects"});
    } else if (levels[i] == scene_effects_level) {
      out.push_back({levels[i], "those of the scene's file"});
    } else {
      design.fail_at("effects", i, "= " + base::toml_quoted(levels[i]) + " has no table",
                     "add [[design.effect_set]] with this name, or use none or scene");
    }
  }
  return out;
}

}  // namespace study
