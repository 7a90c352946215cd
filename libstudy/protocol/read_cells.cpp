/// Reads the cells of a design: levels of the factors, and moments (mean and standard deviation) of the frame
/// rate.
#include <algorithm>
#include <map>
#include <tuple>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

std::string in_words(double value) { return shown(value); }
std::string in_words(const std::string& value) { return base::toml_quoted(value); }

template <class Value>
void check_distinct(const base::TomlTable& table, std::string_view key, std::vector<Value> values) {
  if (values.empty()) table.fail(key, "is empty", "name at least one value");
  if (values.size() > most_cells) {
    table.fail(key, "holds " + std::to_string(values.size()) + " values",
               "name at most " + std::to_string(most_cells));
  }
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice != values.end())
    table.fail(key, "holds a value twice: " + in_words(*twice), "name each value once");
}

std::vector<double> distinct_numbers(const base::TomlTable& table, std::string_view key, base::Range range) {
  const auto values = table.numbers(key, 0, range);
  check_distinct(table, key, values);
  return values;
}

using Moments = std::pair<double, double>;  // mean, standard deviation, frames/s

std::string too_small(double sd) { return "= " + shown(sd) + " is too small to be distinguished from 0"; }
std::string use_more() { return "use 0, or at least " + shown(least_sd_fps); }

/// Pairs every mean with every smaller standard deviation.
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
    table.fail("sd_fps", "has no value below any mean_fps",
               "name at least one standard deviation below a mean");
  return out;
}

/// Levels of the factors of the cells; the moments of the frame rate are read separately.
struct Factors {
  std::vector<std::string> scenes, sizes, methods;
};

void check_level(const base::TomlTable& row, std::string_view key, const std::string& word,
                 const std::vector<std::string>& levels) {
  if (std::find(levels.begin(), levels.end(), word) == levels.end()) {
    row.fail(key, "= " + base::toml_quoted(word) + " names no cell",
             base::use_one_of(word, levels) + " as design." + std::string(key) +
                 " lists them, or remove this row");
  }
}

/// Moments of the frame rate from [[design.moments]], by scene, n_* and method. Cells that differ only in
/// their effects have the same moments.
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
        row.fail("sd_fps", "= " + shown(moments.second) + " is not below mean_fps = " + shown(moments.first),
                 "name a standard deviation smaller than the mean");
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

/// Refuses keys without effect: mean_fps and sd_fps under Native and Table2, moments under Settings.
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

}  // namespace

std::vector<std::string> distinct_words(const base::TomlTable& table, std::string_view key) {
  const auto words = table.strings(key);
  check_distinct(table, key, words);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (base::is_blank(words[i])) table.fail_at(key, i, "is an empty word", "remove it");
  }
  return words;
}

std::vector<Cell> read_cells(const base::TomlTable& table, TimingSource timing,
                             const std::vector<EffectSet>& effects) {
  const Factors factors{distinct_words(table, "scene"), distinct_words(table, "n_star"),
                        distinct_words(table, "method")};
  const double duration_s = table.number("duration_s", duration_range);
  refuse_idle_keys(table, timing);
  const PublishedMoments published(table, factors);
  std::vector<Moments> moments{{0, 0}};
  if (timing == TimingSource::Settings || timing == TimingSource::Equal) moments = read_moments(table);
  if (timing == TimingSource::Equal && moments.size() != 1)
    table.fail("mean_fps", "and sd_fps make more than one setting",
               "give one value of each with timing = \"equal\"");
  std::vector<std::string> levels;
  for (const EffectSet& set : effects) levels.push_back(set.name);
  if (levels.empty()) levels.emplace_back();
  if (factors.scenes.size() * factors.sizes.size() * factors.methods.size() * levels.size() * moments.size() >
      most_cells) {
    table.fail("method", "and the other factors make more than " + std::to_string(most_cells) + " cells",
               "name fewer values");
  }
  std::vector<Cell> out;
  for (const auto& scene : factors.scenes) {
    for (const auto& size : factors.sizes) {
      for (const auto& method : factors.methods) {
        for (const auto& level : levels) {
          const StimulusSpec what{scene, method, size, level};
          for (const auto& wished : moments) {
            const auto [mean, sd] = timing == TimingSource::Table2 ? published.of(what) : wished;
            out.push_back({what, {mean, sd, duration_s}});
          }
        }
      }
    }
  }
  return out;
}

}  // namespace study
