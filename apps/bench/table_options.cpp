#include "apps/bench/table_options.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "apps/common/options.hpp"
#include "libsim/ptpe/ptpe_file.hpp"

namespace apps {

void add_table_options(CLI::App& command, measure::TableOptions& options) {
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

stats::PtpeModel load_model(const std::string& path) {
  if (path.empty()) return {};
  const auto file = sim::read_ptpe_file(path);
  std::printf("ptpe   %s\n", sim::describe(file).c_str());
  return file.model;
}

}  // namespace apps
