#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"
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
    design.fail(
        "effects",
        "holds " + std::to_string(levels.size()) + (levels.size() == 1 ? " level" : " levels") +
            ", and a factor needs at least two",
        "name two levels or more; or remove this key and each [[design.effect_set]], and every cell has "
        "the effects of its scene's file");
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

/// Describes an effect's table in words, such as "foam emission_per_s = 0.3". libsim checks the keys of the
/// table.
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

/// Reads every [[design.effect_set]]; its name must be one of `levels`.
std::vector<EffectSet> read_tables(const base::TomlTable& design, const std::vector<std::string>& levels) {
  std::vector<EffectSet> out;
  for (const auto& table : design.tables("effect_set")) {
    const std::string name = text_of(table, "name");
    if (needs_no_table(name)) {
      table.fail("name", "= " + base::toml_quoted(name) + " is a level that needs no table",
                 "use another name, or remove the table");
    }
    if (std::find(levels.begin(), levels.end(), name) == levels.end()) {
      table.fail(
          "name", "= " + base::toml_quoted(name) + " is no level",
          "use a word that design.effects lists (format 3: that a key effects names), or remove this table");
    }
    if (std::any_of(out.begin(), out.end(), [&](const EffectSet& one) { return one.name == name; }))
      table.fail("name", "= " + base::toml_quoted(name) + " has a table already", "keep one of the two");
    out.push_back(read_set(table, name));
  }
  return out;
}

}  // namespace

std::vector<EffectSet> effect_sets_of(const base::TomlTable& design, const std::vector<std::string>& levels,
                                      const std::function<void(std::size_t)>& no_table) {
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
      no_table(i);
    }
  }
  return out;
}

namespace {

/// Levels of the factor effects; empty if the design does not vary them.
std::vector<EffectSet> read_effect_sets(const base::TomlTable& design) {
  if (!design.has("effects")) {
    if (design.has("effect_set"))
      design.fail("effect_set", "is not used, because the key effects is missing",
                  "write effects = [...] with its name and at least one more level");
    return {};
  }
  const auto levels = read_levels(design);
  return effect_sets_of(design, levels, [&](std::size_t i) {
    design.fail_at("effects", i, "= " + base::toml_quoted(levels[i]) + " has no table", effect_set_mend);
  });
}

// Largest number of sequences of groups (the groups that one participant sees, in order); the assignment
// lists all of them.
constexpr double most_sequences = 50000;
constexpr double most_places = 1e7;  // largest number of different sessions; see check_places()

TimingSource read_timing_source(const base::TomlTable& table) {
  const std::string word = table.choice("timing", {"settings", "native", "equal", "table2"});
  if (word == "native") return TimingSource::Native;
  if (word == "equal") return TimingSource::Equal;
  return word == "table2" ? TimingSource::Table2 : TimingSource::Settings;
}

TrialOrder read_trial_order(const base::TomlTable& table) {
  const std::string word = table.choice("order", {"shuffle", "latin", "williams", "constrained"});
  if (word == "latin") return TrialOrder::Latin;
  if (word == "williams") return TrialOrder::Williams;
  return word == "constrained" ? TrialOrder::Constrained : TrialOrder::Shuffle;
}

template <class Level>
std::size_t distinct_levels(const Design& design, Level level) {
  std::set<std::string> levels;
  for (const auto& cell : design.cells) levels.insert(level(cell.stimulus));
  return levels.size();
}

/// Upper bound on the number of sequences of groups (the groups that one participant sees, in order). In
/// format 2 it counts all sequences with different scenes, also those that spread n_* unevenly. In format 3 a
/// sequence is one group.
double sequences_at_most(const Design& design) {
  if (!design.factors.empty()) return static_cast<double>(cell_groups(design).size());
  const auto scenes = distinct_levels(design, [](const StimulusSpec& what) { return what.scene; });
  const auto sizes = distinct_levels(design, [](const StimulusSpec& what) { return what.n_star; });
  double out = 1;
  for (int i = 0; i < design.groups; ++i)
    out *= (static_cast<double>(scenes) - i) * static_cast<double>(sizes);
  return out;
}

/// Checks that there are enough scenes, because the groups of a participant have different scenes. Limits the
/// number of sequences of groups.
void check_groups(const base::TomlTable& table, const Design& design) {
  const auto scenes = distinct_levels(design, [](const StimulusSpec& what) { return what.scene; });
  if (static_cast<std::size_t>(design.groups) > scenes) {
    table.fail("groups",
               "= " + std::to_string(design.groups) + " groups are more than the " + std::to_string(scenes) +
                   " scenes",
               "use at most one group for each scene");
  }
  const double sequences = sequences_at_most(design);
  if (sequences > most_sequences) {
    table.fail(table.has("groups") ? "groups" : "scene",
               "gives " + shown(sequences) + " sequences of scenes and n_*",
               "name fewer scenes, n_* or groups, for at most " + shown(most_sequences));
  }
}

void check_trial_count(const base::TomlTable& table, const Design& design) {
  const auto cells = static_cast<int>(cell_groups(design).front().size());
  if (design.pairs && cells < 2)
    table.fail("pairs", "need two cells of one scene and n_*",
               "name more methods or effects, or remove pairs");
  const int trials = design.groups * trials_of_group(design);
  if (trials > most_trials) {
    table.fail(design.pairs ? "pairs" : "method",
               "and the other factors make " + std::to_string(trials) + " trials",
               "name fewer values, for at most " + std::to_string(most_trials));
  }
}

/// Limits the number of slots (different sessions) of the assignment, because the assignment counts the uses
/// of each slot. The bound is the number of sequences of groups, times the rows of the order's square (at
/// most two for each trial), and for pairs times 64 for the rounds that balance the order within pairs.
void check_places(const base::TomlTable& table, const Design& design) {
  const bool rows = design.order == TrialOrder::Latin || design.order == TrialOrder::Williams;
  const double places =
      sequences_at_most(design) * (rows ? 2 * trials_of_group(design) : 1) * (design.pairs ? 64 : 1);
  if (places > most_places) {
    table.fail("order",
               "and the sequences of groups give up to " + shown(places) +
                   " different sessions to balance over the participants; at most " + shown(most_places) +
                   " are counted",
               "use order = \"shuffle\", or name fewer scenes, n_* or cells");
  }
}

std::string level_of(const Design& design, const Cell& cell, const std::string& factor) {
  for (std::size_t i = 0; i < design.factors.size(); ++i)
    if (design.factors[i].name == factor) return level_name(design, cell, i);
  if (factor == "method") return cell.stimulus.method;
  if (factor == "effects") return cell.stimulus.effects;
  return shown(factor == "mean_fps" ? cell.setting.mean : cell.setting.sd);
}

/// Refuses a factor if more than half (rounded up) of a group's trials share a level: every order then has
/// neighbours with this level.
void check_never_adjacent(const base::TomlTable& table, const Design& design) {
  const auto group = cell_groups(design).front();
  const auto repetitions = static_cast<std::size_t>(design.repetitions);
  const std::size_t trials = repetitions * group.size();
  for (std::size_t i = 0; i < design.never_adjacent.size(); ++i) {
    std::map<std::string, std::size_t> count;
    for (const int cell : group)
      count[level_of(design, design.cells[static_cast<std::size_t>(cell)], design.never_adjacent[i])] +=
          repetitions;
    for (const auto& [level, times] : count) {
      if (times > (trials + 1) / 2) {
        table.fail_at("never_adjacent", i,
                      "cannot be satisfied: " + std::to_string(times) + " of " + std::to_string(trials) +
                          " trials have " + level,
                      "remove this factor, or remove never_adjacent and use order = \"shuffle\"");
      }
    }
  }
}

void read_never_adjacent(const base::TomlTable& table, Design& design) {
  if (design.order != TrialOrder::Constrained) {
    if (table.has("never_adjacent")) {
      table.fail("never_adjacent", "needs order = \"constrained\"",
                 "change the order or remove never_adjacent");
    }
    return;
  }
  if (design.pairs) {
    table.fail("order", "= \"constrained\" is not supported for pairs",
               "use shuffle, latin or williams, or remove pairs");
  }
  std::vector<std::string> factors{"method", "effects", "mean_fps", "sd_fps"};
  if (!design.factors.empty()) factors.clear();
  for (const DesignFactor& factor : design.factors) factors.push_back(factor.name);
  design.never_adjacent = distinct_words(table, "never_adjacent");
  for (std::size_t i = 0; i < design.never_adjacent.size(); ++i) {
    const std::string& factor = design.never_adjacent[i];
    if (std::find(factors.begin(), factors.end(), factor) == factors.end()) {
      table.fail_at("never_adjacent", i, "= " + base::toml_quoted(factor) + " is no factor",
                    base::use_one_of(factor, factors));
    }
    if (factor == "effects" && design.effects.empty() && design.factors.empty()) {
      table.fail_at("never_adjacent", i, "= \"effects\" is no factor of this design",
                    "write effects = [...], or remove it here");
    }
  }
  check_never_adjacent(table, design);
}

}  // namespace

std::string treatment_name(const StimulusSpec& what) {
  std::string out = what.method;
  for (const std::string* level : {&what.effects, &what.surface})
    if (!level->empty()) out += ", " + *level;
  return out;
}

const std::string& level_name(const Design& design, const Cell& cell, std::size_t factor) {
  return design.factors[factor].levels[static_cast<std::size_t>(cell.levels[factor])];
}

std::string cell_name(const Design& design, const Cell& cell) {
  if (design.factors.empty()) return treatment_name(cell.stimulus);
  std::vector<std::string> words;
  for (std::size_t i = 0; i < design.factors.size(); ++i)
    words.push_back(design.factors[i].name + " " + level_name(design, cell, i));
  return base::joined(words);
}

bool share_level(const Design& design, const Cell& a, const Cell& b) {
  return std::any_of(
      design.never_adjacent.begin(), design.never_adjacent.end(),
      [&](const std::string& factor) { return level_of(design, a, factor) == level_of(design, b, factor); });
}

void read_assignment(const base::TomlTable& table, Design& design) {
  design.order = read_trial_order(table);
  check_places(table, design);
  read_never_adjacent(table, design);
  if (table.choice_or("assignment", "balanced", {"balanced", "paper_random"}) == "paper_random")
    design.assignment = Assignment::PaperRandom;
}

Design read_design(const base::TomlTable& table) {
  Design design;
  design.timing = read_timing_source(table);
  design.effects = read_effect_sets(table);
  if (!design.effects.empty() && design.timing == TimingSource::Settings) {
    table.fail("effects",
               "cannot vary under timing = \"settings\": the pilot fits a curve over frame rates only",
               "use timing = \"equal\", or remove effects");
  }
  design.paint_temperature = table.choice_or("overlay", "none", {"none", "temperature"}) == "temperature";
  design.cells = read_cells(table, design.timing, design.effects);
  design.pairs = table.boolean_or("pairs", false);
  design.groups = static_cast<int>(table.integer_or("groups", 1, {1, 100}));
  check_groups(table, design);
  check_trial_count(table, design);
  read_assignment(table, design);
  return design;
}

}  // namespace study
