#include "libsim/measure/cells.hpp"

#include <cmath>

#include "libsim/ptpe/tolerance_switch.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace measure {

namespace {

/// The tolerance tau, frames/s, that the paper's Table 2 gives for this scene, n_* and method.
double paper_tau(const std::string& scene, const std::string& n_star, sim::MethodKind method) {
  const auto path = base::resource("data/paper/table2_performance.csv");
  const auto lines = base::split(base::read_file(path, 1 << 16), '\n');
  for (const auto& line : lines) {
    const auto cell = base::split(line);
    if (cell.size() < 8 || cell[0] != scene || cell[1] + "k" != n_star || cell[2] != sim::method_name(method))
      continue;
    const auto tau = base::parse_number<double>(cell[7]);
    if (tau && std::isfinite(*tau)) return *tau;
  }
  throw base::Error(
      "--tau table2",
      "the paper's table holds no tau for " + scene + ", " + n_star + ", " + sim::method_name(method),
      "use --tau fixed:-6, or one of the paper's scenes with --n-star 16k or 32k");
}

}  // namespace

std::vector<CellSize> sizes_of(const std::string& words) {
  std::vector<CellSize> out;
  for (const auto& word : base::split(words)) out.push_back({word, sim::parse_n_star(word)});
  if (out.empty()) throw base::Error("--n-star", "names no size", "write for example 16k,32k");
  return out;
}

std::vector<sim::Preset> presets_of(const std::string& word) {
  if (word == "both") return {sim::Preset::Paper, sim::Preset::Tuned};
  return {sim::parse_preset(word)};
}

std::optional<double> tau_of(const std::string& word, const std::string& scene, const std::string& n_star,
                             sim::MethodKind method) {
  if (word == "table2") return paper_tau(scene, n_star, method);
  return sim::parse_tau(word);
}

}  // namespace measure
