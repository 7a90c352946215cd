/// Reads the design of format 3: what a stimulus shows, factors with their levels, and their combinations.
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "libstudy/protocol/names.hpp"
#include "libstudy/protocol/readers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"

namespace study {

namespace {

constexpr std::size_t most_factors = 10;
constexpr std::size_t most_factor_levels = 100;
constexpr base::Range trace_ms_range{shortest_trace_ms, longest_trace_ms};

/// The keys that [stimulus] or a level of a factor sets.
struct StimulusKeys {
  std::optional<std::string> scene, method, n_star, effects, surface;
  std::optional<TimingProfile> timing;
};

StimulusKeys read_keys(const base::TomlTable& table) {
  StimulusKeys out;
  if (table.has("scene")) out.scene = text_of(table, "scene");
  if (table.has("method")) {
    out.method = text_of(table, "method");
    if (!is_method(*out.method))
      table.fail("method", "= " + base::toml_quoted(*out.method) + " is no method",
                 base::use_one_of(*out.method, method_names()));
  }
  if (table.has("n_star")) {
    out.n_star = text_of(table, "n_star");
    if (!is_particle_count(*out.n_star))
      table.fail("n_star", "= " + base::toml_quoted(*out.n_star) + " is no number of particles",
                 "write a whole number, or one with k for 1,024, for example \"32k\"");
  }
  if (table.has("effects")) out.effects = id_of(table, "effects");
  if (table.has("surface")) out.surface = table.choice("surface", surface_names());
  if (table.has("timing")) out.timing = read_profile(table.table("timing"));
  return out;
}

/// Keys that are set, by name.
std::vector<std::string> names_of(const StimulusKeys& keys) {
  std::vector<std::string> out;
  if (keys.scene) out.emplace_back("scene");
  if (keys.method) out.emplace_back("method");
  if (keys.n_star) out.emplace_back("n_star");
  if (keys.effects) out.emplace_back("effects");
  if (keys.surface) out.emplace_back("surface");
  if (keys.timing) out.emplace_back("timing");
  return out;
}

void lay_over(StimulusKeys& below, const StimulusKeys& above) {
  if (above.scene) below.scene = above.scene;
  if (above.method) below.method = above.method;
  if (above.n_star) below.n_star = above.n_star;
  if (above.effects) below.effects = above.effects;
  if (above.surface) below.surface = above.surface;
  if (above.timing) below.timing = above.timing;
}

struct ReadFactor {
  DesignFactor factor;
  std::vector<StimulusKeys> keys;  ///< by level
};

ReadFactor read_factor(const base::TomlTable& table) {
  ReadFactor out;
  out.factor.name = id_of(table, "name");
  out.factor.between = table.choice("vary", {"within", "between"}) == "between";
  const auto levels = table.tables("level");
  if (levels.size() < 2 || levels.size() > most_factor_levels) {
    table.fail("level", "holds " + std::to_string(levels.size()) + " levels",
               "write 2 to " + std::to_string(most_factor_levels) + " tables [[factor.level]]");
  }
  for (const base::TomlTable& level : levels) {
    const std::string name = id_of(level, "name");
    if (std::find(out.factor.levels.begin(), out.factor.levels.end(), name) != out.factor.levels.end())
      level.fail("name", "= " + base::toml_quoted(name) + " is a level of this factor already",
                 "use another name");
    out.factor.levels.push_back(name);
    out.keys.push_back(read_keys(level));
    if (names_of(out.keys.back()) != names_of(out.keys.front()))
      level.fail("name", "= " + base::toml_quoted(name) + " sets other keys than the first level",
                 "set the same of scene, method, n_star, effects, surface and timing in each level");
  }
  if (names_of(out.keys.front()).empty())
    levels.front().fail("name", "= " + base::toml_quoted(out.factor.levels.front()) + " sets no key",
                        "write scene, method, n_star, effects, surface or timing");
  return out;
}

std::vector<ReadFactor> read_factors(const base::TomlTable& root) {
  const auto tables = root.tables("factor");
  if (tables.empty() || tables.size() > most_factors)
    root.fail("factor", "appears " + std::to_string(tables.size()) + " times",
              "write 1 to " + std::to_string(most_factors) + " tables [[factor]]");
  std::vector<ReadFactor> out;
  std::map<std::string, std::string> setter;  // from a key to the factor that sets it
  std::set<std::string> names;
  for (const base::TomlTable& table : tables) {
    out.push_back(read_factor(table));
    const std::string& name = out.back().factor.name;
    if (!names.insert(name).second)
      table.fail("name", "= " + base::toml_quoted(name) + " is the name of another factor",
                 "use another name");
    for (const std::string& key : names_of(out.back().keys.front())) {
      const auto [found, fresh] = setter.emplace(key, name);
      if (!fresh)
        table.fail("level",
                   "sets " + key + ", which factor " + base::toml_quoted(found->second) + " sets too",
                   "let one factor set it");
    }
  }
  return out;
}

/// All combinations of levels; successive combinations differ in the level of the last factor first.
std::vector<std::vector<int>> crossed(const base::TomlTable& root, const std::vector<ReadFactor>& factors) {
  std::vector<std::vector<int>> out{{}};
  for (const ReadFactor& factor : factors) {
    std::vector<std::vector<int>> longer;
    for (const auto& one : out) {
      for (std::size_t level = 0; level < factor.factor.levels.size(); ++level) {
        longer.push_back(one);
        longer.back().push_back(static_cast<int>(level));
      }
    }
    out = std::move(longer);
    if (out.size() > most_cells)
      root.fail("factor", "makes more than " + std::to_string(most_cells) + " cells",
                "use fewer levels, or list the cells as [[combination]]");
  }
  return out;
}

int level_index(const base::TomlTable& table, const DesignFactor& factor) {
  const std::string word = text_of(table, factor.name);
  const auto found = std::find(factor.levels.begin(), factor.levels.end(), word);
  if (found == factor.levels.end())
    table.fail(factor.name, "= " + base::toml_quoted(word) + " is no level of this factor",
               base::use_one_of(word, factor.levels));
  return static_cast<int>(found - factor.levels.begin());
}

std::vector<std::vector<int>> listed(const base::TomlTable& root, const std::vector<ReadFactor>& factors) {
  const auto tables = root.tables("combination");
  if (tables.size() > most_cells)
    root.fail("combination", "appears " + std::to_string(tables.size()) + " times",
              "write at most " + std::to_string(most_cells) + " tables [[combination]]");
  std::vector<std::vector<int>> out;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    std::vector<int> levels;
    for (const ReadFactor& factor : factors) levels.push_back(level_index(tables[i], factor.factor));
    if (std::find(out.begin(), out.end(), levels) != out.end())
      root.fail_at("combination", i, "repeats an earlier combination", "list each combination once");
    out.push_back(levels);
  }
  for (std::size_t f = 0; f < factors.size(); ++f) {
    for (std::size_t level = 0; level < factors[f].factor.levels.size(); ++level) {
      const bool used = std::any_of(out.begin(), out.end(),
                                    [&](const auto& one) { return one[f] == static_cast<int>(level); });
      if (!used)
        root.fail("combination",
                  "never has level " + base::toml_quoted(factors[f].factor.levels[level]) + " of factor " +
                      base::toml_quoted(factors[f].factor.name),
                  "add a combination with it, or remove the level");
    }
  }
  return out;
}

/// Sorts the combinations so that those of one between-subject group are neighbours. Within a group their
/// order does not change.
void sort_by_group(std::vector<std::vector<int>>& combinations, const std::vector<ReadFactor>& factors) {
  std::stable_sort(combinations.begin(), combinations.end(), [&](const auto& a, const auto& b) {
    for (std::size_t f = 0; f < factors.size(); ++f)
      if (factors[f].factor.between && a[f] != b[f]) return a[f] < b[f];
    return false;
  });
}

Cell cell_of(const base::TomlTable& root, const StimulusKeys& keys, double duration_s) {
  const auto needed = [&](const auto& value, const char* key) {
    if (!value)
      root.fail("stimulus", "names no " + std::string(key) + ", and no factor sets it",
                "write " + std::string(key) + " in [stimulus], or in each level of one factor");
    return *value;
  };
  Cell cell;
  cell.stimulus = {needed(keys.scene, "scene"), needed(keys.method, "method"), needed(keys.n_star, "n_star"),
                   keys.effects.value_or(""), keys.surface.value_or("")};
  const TimingProfile timing = needed(keys.timing, "timing");
  try {
    cell.setting = setting_of(timing, duration_s);
  } catch (const base::Error& error) {
    const std::string words = error.what();
    root.fail("factor", "makes a " + words.substr(0, words.find('\n')),
              "change the numbers of this timing, or duration_s");
  }
  return cell;
}

/// Levels of effects that any cell shows, in order of first use. If some cells name a level, the others get
/// the level "scene".
std::vector<std::string> used_effects(std::vector<Cell>& cells) {
  const bool any =
      std::any_of(cells.begin(), cells.end(), [](const Cell& c) { return !c.stimulus.effects.empty(); });
  std::vector<std::string> out;
  for (Cell& cell : cells) {
    if (any && cell.stimulus.effects.empty()) cell.stimulus.effects = scene_effects_level;
    const std::string& level = cell.stimulus.effects;
    if (!level.empty() && std::find(out.begin(), out.end(), level) == out.end()) out.push_back(level);
  }
  return out;
}

/// Checks that every cell is a standard or is compared with one, and that every standard is compared.
void check_standards(const base::TomlTable& table, const Design& design) {
  for (const auto& group : cell_groups(design)) {
    std::set<int> paired;
    for (const auto& [cell, standard] : pairs_of_group(design, group)) paired.insert({cell, standard});
    const auto alone = std::find_if(group.begin(), group.end(), [&](int i) { return !paired.contains(i); });
    if (paired.empty())
      table.fail("standard", "is no cell of the design", "name a combination that exists in each group");
    if (alone == group.end()) continue;
    const Cell& cell = design.cells[static_cast<std::size_t>(*alone)];
    table.fail("standard",
               std::string(is_standard(design, cell) ? "has no cell to compare with "
                                                     : "has no cell for the comparison with ") +
                   cell_name(design, cell),
               "list both cells as [[combination]], or name a level of each within-subject factor");
  }
}

void read_standard(const base::TomlTable& table, Design& design) {
  if (!table.has("standard")) return;
  if (!design.pairs) table.fail("standard", "needs pairs = true", "write pairs = true, or remove standard");
  const auto named = table.table("standard");
  std::vector<std::optional<int>> levels;
  bool any = false;
  for (const DesignFactor& factor : design.factors) {
    levels.emplace_back();
    if (factor.between || !named.has(factor.name)) continue;
    levels.back() = level_index(named, factor);
    any = true;
  }
  if (!any)
    table.fail("standard", "names no level of a within-subject factor",
               "write a level, as in standard = {hitch = \"none\"}, or remove it");
  design.standard = levels;
  check_standards(table, design);
}

void check_groups_alike(const base::TomlTable& root, const base::TomlTable& table, const Design& design) {
  const auto groups = cell_groups(design);
  for (const auto& group : groups) {
    if (group.size() == groups.front().size()) continue;
    root.fail("combination",
              "lists " + std::to_string(group.size()) + " cells for one between-subject group and " +
                  std::to_string(groups.front().size()) + " for another",
              "list equally many for each");
  }
  if (design.pairs && groups.front().size() < 2)
    table.fail("pairs", "need two cells that a participant sees",
               "add a within-subject factor, or remove pairs");
  const int trials = trials_of_group(design);
  if (trials > most_trials)
    table.fail("repetitions",
               "(with [procedure]: its trials) and the factors make " + std::to_string(trials) +
                   " trials of one participant",
               "use fewer, for at most " + std::to_string(most_trials));
}

}  // namespace

TimingProfile read_profile(const base::TomlTable& table) {
  TimingProfile out;
  const std::string word = table.choice("profile", {"moments", "hitches", "floor", "trace"});
  if (word == "moments") {
    out.mean_fps = table.number("mean_fps", fps_range);
    out.sd_fps = table.number_or("sd_fps", 0, {0, fps_range.max});
    if (out.sd_fps >= out.mean_fps)
      table.fail("sd_fps", "= " + shown(out.sd_fps) + " is not below mean_fps = " + shown(out.mean_fps),
                 "name a smaller standard deviation");
  } else if (word == "hitches") {
    out.kind = ProfileKind::Hitches;
    out.mean_fps = table.number("base_fps", fps_range);
    out.hitch_ms = table.number("hitch_ms", {1, 10000});
    out.period_s = table.number("period_s", {0.01, 3600});
    out.jitter = table.number_or("jitter", 0, {0, 1});
  } else if (word == "floor") {
    out.kind = ProfileKind::Floor;
    out.mean_fps = table.number("mean_fps", fps_range);
    out.low_fps = table.number("low_fps", fps_range);
  } else {
    out.kind = ProfileKind::Trace;
    out.frame_ms = table.numbers("frame_ms", 0, trace_ms_range);
    if (out.frame_ms.size() < 2 || out.frame_ms.size() > most_trace_frames)
      table.fail("frame_ms", "holds " + std::to_string(out.frame_ms.size()) + " frames",
                 "give 2 to " + std::to_string(most_trace_frames));
    out.smoothed = table.boolean_or("smoothed", false);
  }
  out.latency_ms = table.number_or("latency_ms", 0, {0, 10000});
  out.animation_error_ms = table.number_or("animation_error_ms", 0, {0, 1000});
  return out;
}

Design read_factor_design(const base::TomlTable& root, const base::TomlTable& table,
                          const base::TomlTable* procedure) {
  Design design;
  design.timing = TimingSource::Profiles;
  const double duration_s = table.number("duration_s", duration_range);
  const StimulusKeys common = root.has("stimulus") ? read_keys(root.table("stimulus")) : StimulusKeys();
  const auto factors = read_factors(root);
  for (const ReadFactor& factor : factors) design.factors.push_back(factor.factor);
  auto combinations = root.has("combination") ? listed(root, factors) : crossed(root, factors);
  sort_by_group(combinations, factors);
  for (const auto& levels : combinations) {
    StimulusKeys keys = common;
    for (std::size_t f = 0; f < factors.size(); ++f)
      lay_over(keys, factors[f].keys[static_cast<std::size_t>(levels[f])]);
    design.cells.push_back(cell_of(root, keys, duration_s));
    design.cells.back().levels = levels;
  }
  for (const Cell& cell : design.cells) {
    const auto& profile = cell.setting.profile;
    if (profile && profile->kind == ProfileKind::Hitches && profile->period_s > duration_s)
      table.fail("duration_s",
                 "= " + shown(duration_s) + " is shorter than the period of " + shown(profile->period_s) +
                     " s of a profile with hitches, so that no hitch may be shown",
                 "use a longer duration_s or a shorter period_s");
  }
  const auto effects = used_effects(design.cells);
  design.effects = effect_sets_of(table, effects, [&](std::size_t i) {
    root.fail("stimulus",
              "or a level names effects = " + base::toml_quoted(effects[i]) + ", which has no table",
              effect_set_mend);
  });
  design.paint_temperature = table.choice_or("overlay", "none", {"none", "temperature"}) == "temperature";
  design.repetitions = static_cast<int>(table.integer_or("repetitions", 1, {1, 200}));
  design.pairs = table.boolean_or("pairs", false);
  read_standard(table, design);
  read_assignment(table, design);
  if (procedure) design.procedure = read_procedure(*procedure, design);
  check_groups_alike(root, table, design);
  return design;
}

}  // namespace study
