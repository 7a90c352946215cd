#include <algorithm>
#include <map>
#include <tuple>

#include "libstudy/protocol/readers.hpp"

namespace study {

namespace {

constexpr std::size_t most_cells = 1000;

template <class Value>
void check_distinct(const base::TomlTable& table, std::string_view key, std::vector<Value> values) {
  if (values.empty()) table.fail(key, "is empty", "name at least one value");
  std::sort(values.begin(), values.end());
  if (std::adjacent_find(values.begin(), values.end()) != values.end())
    table.fail(key, "holds a value twice", "name each value once");
}

std::vector<std::string> distinct_words(const base::TomlTable& table, std::string_view key) {
  const auto words = table.strings(key);
  check_distinct(table, key, words);
  for (const auto& word : words) {
    if (word.find_first_not_of(" \t") == std::string::npos)
      table.fail(key, "holds an empty word", "remove it");
  }
  return words;
}

std::vector<double> distinct_numbers(const base::TomlTable& table, std::string_view key, base::Range range) {
  const auto values = table.numbers(key, 0, range);
  check_distinct(table, key, values);
  return values;
}

using Moments = std::pair<double, double>;  // mean, standard deviation, frames/s

/// Every mean with every standard deviation below it.
std::vector<Moments> read_moments(const base::TomlTable& table) {
  const auto means = distinct_numbers(table, "mean_fps", fps_range);
  const auto sds = distinct_numbers(table, "sd_fps", {0, fps_range.max});
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

/// [[design.moments]]: one for each cell.
class PublishedMoments {
 public:
  explicit PublishedMoments(const base::TomlTable& design) : design_(design) {
    for (const auto& row : design.tables("moments")) {
      const auto key = std::tuple(text_of(row, "scene"), text_of(row, "n_star"), text_of(row, "method"));
      const double mean = row.number("mean_fps", fps_range);
      const Moments moments{mean, row.number("sd_fps", {0, mean})};
      if (!moments_.emplace(key, moments).second)
        row.fail("method", "names a cell for the second time", "name each cell once");
    }
  }

  Moments of(const StimulusSpec& what) const {
    const auto found = moments_.find({what.scene, what.n_star, what.method});
    if (found == moments_.end()) {
      design_.fail("timing",
                   "needs the moments of " + what.method + ", " + what.scene + ", n_* " + what.n_star,
                   "add [[design.moments]] with this scene, n_star, method, mean_fps and sd_fps");
    }
    return found->second;
  }

 private:
  const base::TomlTable& design_;
  std::map<std::tuple<std::string, std::string, std::string>, Moments> moments_;
};

TimingSource read_timing_source(const base::TomlTable& table) {
  const std::string word = table.choice("timing", {"settings", "native", "equal", "table2"});
  if (word == "native") return TimingSource::Native;
  if (word == "equal") return TimingSource::Equal;
  return word == "table2" ? TimingSource::Table2 : TimingSource::Settings;
}

std::vector<Cell> read_cells(const base::TomlTable& table, TimingSource timing) {
  const auto scenes = distinct_words(table, "scene");
  const auto sizes = distinct_words(table, "n_star");
  const auto methods = distinct_words(table, "method");
  const double duration_s = table.number("duration_s", duration_range);
  const PublishedMoments published(table);
  std::vector<Moments> moments{{0, 0}};
  if (timing == TimingSource::Settings || timing == TimingSource::Equal) moments = read_moments(table);
  if (timing == TimingSource::Equal && moments.size() != 1)
    table.fail("mean_fps", "and sd_fps make more than one setting", "give one value of each with equal");
  if (scenes.size() * sizes.size() * methods.size() * moments.size() > most_cells) {
    table.fail("mean_fps", "and the other factors make more than " + std::to_string(most_cells) + " cells",
               "name fewer values");
  }
  std::vector<Cell> out;
  for (const auto& scene : scenes) {
    for (const auto& size : sizes) {
      for (const auto& method : methods) {
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

/// Different scenes come first: a participant never meets one twice.
void check_groups(const base::TomlTable& table, const Design& design) {
  std::vector<std::string> scenes;
  for (const auto& cell : design.cells) scenes.push_back(cell.stimulus.scene);
  std::sort(scenes.begin(), scenes.end());
  const auto count = std::unique(scenes.begin(), scenes.end()) - scenes.begin();
  if (design.groups > count) {
    table.fail("groups", "are more than the " + std::to_string(count) + " scenes",
               "use at most one group for each scene");
  }
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

Design read_design(const base::TomlTable& table) {
  Design design;
  design.timing = read_timing_source(table);
  design.cells = read_cells(table, design.timing);
  design.pairs = table.boolean_or("pairs", false);
  if (design.pairs && cell_groups(design).front().size() < 2)
    table.fail("pairs", "need two cells of one scene and n_*", "name more methods, or remove pairs");
  design.groups = static_cast<int>(table.integer_or("groups", 1, {1, 100}));
  check_groups(table, design);
  design.order = read_trial_order(table);
  if (design.order == TrialOrder::Constrained) {
    design.never_adjacent = distinct_words(table, "never_adjacent");
    for (const auto& factor : design.never_adjacent) {
      if (factor != "method" && factor != "mean_fps" && factor != "sd_fps")
        table.fail("never_adjacent", "names '" + factor + "'", "use method, mean_fps or sd_fps");
    }
  }
  if (table.has("assignment") && table.choice("assignment", {"balanced", "paper_random"}) == "paper_random") {
    design.assignment = Assignment::PaperRandom;
  }
  return design;
}

}  // namespace study
