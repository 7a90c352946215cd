#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/protocol/readers.hpp"

namespace study {

namespace {

constexpr std::size_t most_cells = 1000;
constexpr int most_trials = 1000;         // of one participant
constexpr double most_sequences = 50000;  // of groups; the assignment lists them all
constexpr double most_places = 1e7;

template <class Value>
void check_distinct(const base::TomlTable& table, std::string_view key, std::vector<Value> values) {
  if (values.empty()) table.fail(key, "is empty", "name at least one value");
  if (values.size() > most_cells) {
    table.fail(key, "holds " + std::to_string(values.size()) + " values",
               "name at most " + std::to_string(most_cells));
  }
  std::sort(values.begin(), values.end());
  if (std::adjacent_find(values.begin(), values.end()) != values.end())
    table.fail(key, "holds a value twice", "name each value once");
}

std::vector<std::string> distinct_words(const base::TomlTable& table, std::string_view key) {
  const auto words = table.strings(key);
  check_distinct(table, key, words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].find_first_not_of(" \t\r\n") == std::string::npos)
      table.fail_at(key, i, "is an empty word", "remove it");
  }
  return words;
}

std::vector<double> distinct_numbers(const base::TomlTable& table, std::string_view key, base::Range range) {
  const auto values = table.numbers(key, 0, range);
  check_distinct(table, key, values);
  return values;
}

using Moments = std::pair<double, double>;  // mean, standard deviation, frames/s

std::string too_small(double sd) { return "= " + shown(sd) + " is too small to be told from 0"; }
std::string use_more() { return "use 0, or at least " + shown(least_sd_fps); }

/// Every mean with every standard deviation below it.
std::vector<Moments> read_moments(const base::TomlTable& table) {
  const auto means = distinct_numbers(table, "mean_fps", fps_range);
  const auto sds = distinct_numbers(table, "sd_fps", {0, fps_range.max});
  for (std::size_t i = 0; i < sds.size(); ++i)
    if (sds[i] > 0 && sds[i] < least_sd_fps) table.fail_at("sd_fps", i, too_small(sds[i]), use_more());
  std::vector<Moments> out;
  for (const double mean : means) {
    for (const double sd : sds) {
      if (sd < mean) out.emplace_back(mean, sd);
    }
  }
  if (out.empty())
    table.fail("sd_fps", "has no value below a mean", "name a standard deviation smaller than a mean");
  return out;
}

/// What the cells are made of beside their moments.
struct Factors {
  std::vector<std::string> scenes, sizes, methods;
};

void check_level(const base::TomlTable& row, std::string_view key, const std::string& word,
                 const std::vector<std::string>& levels) {
  if (std::find(levels.begin(), levels.end(), word) == levels.end()) {
    row.fail(key, "= " + base::toml_quoted(word) + " names no cell",
             "use a value that design." + std::string(key) + " lists, or remove this row");
  }
}

/// [[design.moments]]: one for each cell.
class PublishedMoments {
 public:
  PublishedMoments(const base::TomlTable& design, const Factors& factors) : design_(design) {
    for (const auto& row : design.tables("moments")) {
      const StimulusSpec what{text_of(row, "scene"), text_of(row, "method"), text_of(row, "n_star")};
      check_level(row, "scene", what.scene, factors.scenes);
      check_level(row, "method", what.method, factors.methods);
      check_level(row, "n_star", what.n_star, factors.sizes);
      const Moments moments{row.number("mean_fps", fps_range), row.number("sd_fps", {0, fps_range.max})};
      if (moments.second > 0 && moments.second < least_sd_fps)
        row.fail("sd_fps", too_small(moments.second), use_more());
      if (moments.second >= moments.first)
        row.fail("sd_fps", "is not below mean_fps", "name a standard deviation smaller than the mean");
      if (!moments_.emplace(key_of(what), moments).second)
        row.fail("method", "names a cell for the second time", "name each cell once");
    }
  }

  Moments of(const StimulusSpec& what) const {
    const auto found = moments_.find(key_of(what));
    if (found == moments_.end()) {
      design_.fail("timing",
                   "needs the moments of " + what.method + ", " + what.scene + ", n_* " + what.n_star,
                   "add [[design.moments]] with this scene, n_star, method, mean_fps and sd_fps");
    }
    return found->second;
  }

 private:
  static std::tuple<std::string, std::string, std::string> key_of(const StimulusSpec& what) {
    return {what.scene, what.n_star, what.method};
  }

  const base::TomlTable& design_;
  std::map<std::tuple<std::string, std::string, std::string>, Moments> moments_;
};

TimingSource read_timing_source(const base::TomlTable& table) {
  const std::string word = table.choice("timing", {"settings", "native", "equal", "table2"});
  if (word == "native") return TimingSource::Native;
  if (word == "equal") return TimingSource::Equal;
  return word == "table2" ? TimingSource::Table2 : TimingSource::Settings;
}

/// Keys that this source of moments does not read.
void refuse_idle_keys(const base::TomlTable& table, TimingSource timing) {
  const bool reads_lists = timing == TimingSource::Settings || timing == TimingSource::Equal;
  for (const char* key : {"mean_fps", "sd_fps"}) {
    if (!reads_lists && table.has(key)) {
      table.fail(key, "has no effect with this timing",
                 "remove it, or write timing = \"settings\" or \"equal\"");
    }
  }
  if (timing == TimingSource::Settings && table.has("moments")) {
    table.fail("moments", "have no effect with timing = \"settings\"",
               "remove them, or write timing = \"table2\"");
  }
}

std::vector<Cell> read_cells(const base::TomlTable& table, TimingSource timing) {
  const Factors factors{distinct_words(table, "scene"), distinct_words(table, "n_star"),
                        distinct_words(table, "method")};
  const double duration_s = table.number("duration_s", duration_range);
  refuse_idle_keys(table, timing);
  const PublishedMoments published(table, factors);
  std::vector<Moments> moments{{0, 0}};
  if (timing == TimingSource::Settings || timing == TimingSource::Equal) moments = read_moments(table);
  if (timing == TimingSource::Equal && moments.size() != 1)
    table.fail("mean_fps", "and sd_fps make more than one setting", "give one value of each with equal");
  if (factors.scenes.size() * factors.sizes.size() * factors.methods.size() * moments.size() > most_cells) {
    table.fail("method", "and the other factors make more than " + std::to_string(most_cells) + " cells",
               "name fewer values");
  }
  std::vector<Cell> out;
  for (const auto& scene : factors.scenes) {
    for (const auto& size : factors.sizes) {
      for (const auto& method : factors.methods) {
        const StimulusSpec what{scene, method, size};
        for (const auto& wished : moments) {
          const auto [mean, sd] = timing == TimingSource::Table2 ? published.of(what) : wished;
          out.push_back({what, {mean, sd, duration_s}});
        }
      }
    }
  }
  return out;
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

/// Orders in which a participant can meet groups of different scenes, before n_* is spread evenly.
double sequences_at_most(const Design& design) {
  const auto scenes = distinct_levels(design, [](const StimulusSpec& what) { return what.scene; });
  const auto sizes = distinct_levels(design, [](const StimulusSpec& what) { return what.n_star; });
  double out = 1;
  for (int i = 0; i < design.groups; ++i)
    out *= (static_cast<double>(scenes) - i) * static_cast<double>(sizes);
  return out;
}

/// Different scenes come first: a participant never meets one twice.
void check_groups(const base::TomlTable& table, const Design& design) {
  const auto scenes = distinct_levels(design, [](const StimulusSpec& what) { return what.scene; });
  if (static_cast<std::size_t>(design.groups) > scenes) {
    table.fail("groups", "are more than the " + std::to_string(scenes) + " scenes",
               "use at most one group for each scene");
  }
  const double sequences = sequences_at_most(design);
  if (sequences > most_sequences) {
    table.fail(table.has("groups") ? "groups" : "scene",
               "can be met in " + shown(sequences) + " orders of scenes and n_*",
               "name fewer scenes, n_* or groups, for at most " + shown(most_sequences));
  }
}

void check_trials(const base::TomlTable& table, const Design& design) {
  const auto cells = static_cast<int>(cell_groups(design).front().size());
  if (design.pairs && cells < 2)
    table.fail("pairs", "need two cells of one scene and n_*", "name more methods, or remove pairs");
  const int trials = design.groups * trials_of_group(design);
  if (trials > most_trials) {
    table.fail(design.pairs ? "pairs" : "method",
               "and the other factors make " + std::to_string(trials) + " trials",
               "name fewer values, for at most " + std::to_string(most_trials));
  }
}

/// The assignment counts how often each of its places is taken.
void check_places(const base::TomlTable& table, const Design& design) {
  const bool rows = design.order == TrialOrder::Latin || design.order == TrialOrder::Williams;
  const double places =
      sequences_at_most(design) * (rows ? 2 * trials_of_group(design) : 1) * (design.pairs ? 64 : 1);
  if (places > most_places) {
    table.fail("order", "and the sequences of groups make up to " + shown(places) + " places to balance",
               "use order = \"shuffle\", or name fewer scenes, n_* or cells");
  }
}

/// The level of a factor as text.
std::string level_of(const Cell& cell, const std::string& factor) {
  if (factor == "method") return cell.stimulus.method;
  return shown(factor == "mean_fps" ? cell.setting.mean : cell.setting.sd);
}

/// More than half of the trials with one level leave no order in which it never stands beside itself.
void check_never_adjacent(const base::TomlTable& table, const Design& design) {
  const auto group = cell_groups(design).front();
  for (std::size_t i = 0; i < design.never_adjacent.size(); ++i) {
    std::map<std::string, std::size_t> count;
    for (const int cell : group)
      ++count[level_of(design.cells[static_cast<std::size_t>(cell)], design.never_adjacent[i])];
    for (const auto& [level, times] : count) {
      if (times > (group.size() + 1) / 2) {
        table.fail_at("never_adjacent", i,
                      "cannot be kept: " + std::to_string(times) + " of " + std::to_string(group.size()) +
                          " trials have " + level,
                      "remove this factor");
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
    table.fail("order", "= \"constrained\" cannot be kept by pairs",
               "use shuffle, latin or williams, or remove pairs");
  }
  design.never_adjacent = distinct_words(table, "never_adjacent");
  for (std::size_t i = 0; i < design.never_adjacent.size(); ++i) {
    const std::string& factor = design.never_adjacent[i];
    if (factor != "method" && factor != "mean_fps" && factor != "sd_fps") {
      table.fail_at("never_adjacent", i, "= " + base::toml_quoted(factor) + " is no factor",
                    "use method, mean_fps or sd_fps");
    }
  }
  check_never_adjacent(table, design);
}

}  // namespace

std::vector<std::vector<int>> cell_groups(const Design& design) {
  std::vector<std::vector<int>> out;
  const StimulusSpec* last = nullptr;
  for (std::size_t i = 0; i < design.cells.size(); ++i) {
    const StimulusSpec& what = design.cells[i].stimulus;
    if (!last || what.scene != last->scene || what.n_star != last->n_star) out.emplace_back();
    out.back().push_back(static_cast<int>(i));
    last = &what;
  }
  return out;
}

int trials_of_group(const Design& design) {
  const auto k = static_cast<int>(cell_groups(design).front().size());
  return design.pairs ? k * (k - 1) / 2 : k;
}

Design read_design(const base::TomlTable& table) {
  Design design;
  design.timing = read_timing_source(table);
  design.cells = read_cells(table, design.timing);
  design.pairs = table.boolean_or("pairs", false);
  design.groups = static_cast<int>(table.integer_or("groups", 1, {1, 100}));
  check_groups(table, design);
  check_trials(table, design);
  design.order = read_trial_order(table);
  check_places(table, design);
  read_never_adjacent(table, design);
  if (table.choice_or("assignment", "balanced", {"balanced", "paper_random"}) == "paper_random")
    design.assignment = Assignment::PaperRandom;
  return design;
}

}  // namespace study
