#include "libsim/measure/cell_scores.hpp"

#include <cmath>
#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"
#include "stats/mean_interval.hpp"

namespace measure {

namespace {

constexpr std::size_t most_bytes = std::size_t{256} << 20;
constexpr std::size_t key_columns = 8;

const MetricTraits& traits_of(Metric metric) { return all_metrics()[static_cast<std::size_t>(metric)]; }

std::vector<std::string> score_head() {
  std::vector<std::string> out{"scene",      "n_star", "preset", "method",
                               "checkpoint", "start",  "gaze",   "repeat"};
  for (const Metric metric : still_metrics) out.emplace_back(traits_of(metric).name);
  return out;
}

/// Keys of one method's pictures, in the order of Series::cells.
std::vector<CellKey> keys_of(const ScoreBlock& block, const MethodScores& scores) {
  std::vector<CellKey> out;
  const auto repeats = static_cast<int>(scores.of(still_metrics[0]).repeats);
  for (std::size_t c = 0; c < block.checkpoints.size(); ++c) {
    for (int gaze = 1; gaze <= block.gazes; ++gaze) {
      for (int repeat = 1; repeat <= repeats; ++repeat) {
        out.push_back({block.scene, block.n_star, sim::preset_name(block.preset),
                       sim::method_name(scores.method), block.checkpoints[c], block.starts.at(c), gaze,
                       repeat});
      }
    }
  }
  return out;
}

std::string in_words(const CellKey& key) {
  return key.scene + " " + key.n_star + " " + key.preset + " " + key.method + ", checkpoint " +
         std::to_string(key.checkpoint) + " (start " + key.start + "), gaze " + std::to_string(key.gaze) +
         ", repeat " + std::to_string(key.repeat);
}

std::string exact(double value) {
  if (std::isnan(value)) return "nan";  // not "-nan", whatever the sign of the NaN
  return base::shortest(value);
}

template <class Number>
bool reads(const std::string& text, Number& value) {
  const auto number = base::parse_number<Number>(text);
  if (number) value = *number;
  return number.has_value();
}

bool reads_row(const std::vector<std::string>& cells, CellKey& key, CellValues& values) {
  if (cells.size() != key_columns + values.size()) return false;
  key = {cells[0], cells[1], cells[2], cells[3], 0, cells[5], 0, 0};
  bool good = reads(cells[4], key.checkpoint) && reads(cells[6], key.gaze) && reads(cells[7], key.repeat);
  for (std::size_t i = 0; i < values.size(); ++i) good = good && reads(cells[key_columns + i], values[i]);
  return good;
}

/// "3 WHAT, the first: KEY", with the number of keys and the first of them; empty without keys.
std::string told(const std::vector<CellKey>& keys, const std::string& what) {
  if (keys.empty()) return "";
  return std::to_string(keys.size()) + " " + what + ", the first: " + in_words(keys.front());
}

}  // namespace

figures::TextTable cell_rows(const std::vector<ScoreBlock>& blocks) {
  figures::TextTable out{score_head(), {}};
  for (const auto& block : blocks) {
    for (const auto& scores : block.methods) {
      const auto keys = keys_of(block, scores);
      if (scores.of(still_metrics[0]).cells.size() != keys.size()) continue;
      for (std::size_t i = 0; i < keys.size(); ++i) {
        const CellKey& key = keys[i];
        std::vector<std::string> row{key.scene,
                                     key.n_star,
                                     key.preset,
                                     key.method,
                                     std::to_string(key.checkpoint),
                                     key.start,
                                     std::to_string(key.gaze),
                                     std::to_string(key.repeat)};
        for (const Metric metric : still_metrics) row.push_back(exact(scores.of(metric).cells[i].value));
        out.rows.push_back(row);
      }
    }
  }
  return out;
}

CellScores read_cells(const std::filesystem::path& path) {
  std::istringstream lines(base::read_file(path, most_bytes));
  std::string line;
  std::getline(lines, line);
  if (base::split(line) != score_head())
    throw base::Error(path.string(), "is no table of single pictures", "give a file that --cells wrote");
  CellScores out;
  for (int number = 2; std::getline(lines, line); ++number) {
    CellKey key;
    CellValues values{};
    const std::string place = path.string() + ":" + std::to_string(number);
    if (!reads_row(base::split(line), key, values))
      throw base::Error(place,
                        "is not a row of scores as --cells writes it: \"" + base::shortened(line) + "\"",
                        "write the file again with --cells");
    if (!out.emplace(key, values).second)
      throw base::Error(place, "names a picture a second time: " + in_words(key),
                        "write the file again with --cells");
  }
  return out;
}

void check_paired(const std::vector<ScoreBlock>& blocks, const CellScores& then, const std::string& path) {
  std::vector<CellKey> missing, left;
  CellScores unused = then;
  for (const auto& block : blocks) {
    for (const auto& scores : block.methods) {
      for (const auto& key : keys_of(block, scores)) {
        if (unused.erase(key) == 0) missing.push_back(key);
      }
    }
  }
  for (const auto& [key, values] : unused) left.push_back(key);
  if (missing.empty() && left.empty()) return;
  const std::string lacks = told(missing, "pictures of this run are not in it"),
                    more = told(left, "pictures in it are not in this run");
  throw base::Error(
      "--paired-with " + path, lacks + (lacks.empty() || more.empty() ? "" : "; ") + more,
      "give --checkpoints-from with the checkpoints of the run that wrote it, and that run's --scene, "
      "--n-star, --preset, --checkpoints, --gazes and --repeats");
}

figures::TextTable change_rows(const std::vector<ScoreBlock>& now, const CellScores& then) {
  figures::TextTable out{
      {"scene", "n_star", "preset", "method", "metric", "now_minus_then", "ci_low", "ci_high", "groups"}, {}};
  for (const auto& block : now) {
    for (const auto& scores : block.methods) {
      const auto keys = keys_of(block, scores);
      for (std::size_t m = 0; m < still_metrics.size(); ++m) {
        const MetricTraits& metric = traits_of(still_metrics[m]);
        const Series& series = scores.of(metric.metric);
        std::vector<double> values, before;
        for (const auto& cell : series.cells) values.push_back(cell.value);
        for (const auto& key : keys) before.push_back(then.at(key)[m]);
        const auto s = stats::mean_interval(stats::paired_group_means(values, before, series.repeats));
        const int digits = metric.digits + 1;
        out.rows.push_back({block.scene, block.n_star, sim::preset_name(block.preset),
                            sim::method_name(scores.method), metric.name, figures::number(s.mean, digits),
                            figures::number(s.low, digits), figures::number(s.high, digits),
                            std::to_string(s.n)});
      }
    }
  }
  return out;
}

}  // namespace measure
