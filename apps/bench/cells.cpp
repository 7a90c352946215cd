#include "apps/bench/cells.hpp"

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "apps/common/options.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

std::vector<std::string> split(const std::string& words, char by) {
  std::vector<std::string> out;
  std::istringstream stream(words);
  for (std::string word; std::getline(stream, word, by);) out.push_back(word);
  return out;
}

bool read_number(const std::string& text, double& value) {
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end && std::isfinite(value);
}

/// tau of a cell in the paper's Table 2.
double paper_tau(const std::string& scene, const std::string& n_star, sim::MethodKind method) {
  const auto path = base::resource("data/paper/table2_performance.csv");
  const auto lines = split(base::read_file(path, 1 << 16), '\n');
  for (const auto& line : lines) {
    const auto cell = split(line, ',');
    double tau = 0;
    if (cell.size() < 8 || cell[0] != scene || cell[1] + "k" != n_star || cell[2] != sim::method_name(method))
      continue;
    if (read_number(cell[7], tau)) return tau;
  }
  throw base::Error(
      "--tau table2",
      "the paper's table holds no tau for " + scene + ", " + n_star + ", " + sim::method_name(method),
      "use --tau fixed:-6, or n_* 16k or 32k");
}

}  // namespace

void add_table_options(CLI::App& command, TableOptions& options) {
  command.add_option("--scene", options.scene, "all, SingleDam, JetImpact or Faucet")->capture_default_str();
  command
      .add_option("--n-star", options.n_star,
                  "Number of particles if all were at the coarsest level; several separated by commas")
      ->capture_default_str();
  command.add_option("--preset", options.preset, "tuned, paper or both")->capture_default_str();
  command.add_option("--tau", options.tau, "live, fixed:X (frames/s) or table2 (the paper's)")
      ->capture_default_str();
  add_backend(command, options.backend);
  command.add_option("--csv", options.csv, "File for the rows")->check(output_file());
  command.add_option("--markdown", options.markdown, "File for the same as a table")->check(output_file());
  command.add_option("--svg", options.svg_folder, "Folder for figures; made when missing")
      ->check(output_folder());
}

std::vector<CellSize> sizes_of(const std::string& words) {
  std::vector<CellSize> out;
  for (const auto& word : split(words, ',')) out.push_back({word, sim::parse_n_star(word)});
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

stats::PtpeModel load_model(const std::string& path) {
  if (path.empty()) return {};
  const auto file = sim::read_ptpe_file(path);
  std::printf("ptpe   %s\n", sim::describe(file).c_str());
  return file.model;
}

}  // namespace apps
