/// vip-stats: from the database to figures, decisions and the solver's file.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/common/program.hpp"
#include "apps/stats/heat_map.hpp"
#include "apps/stats/pilot_data.hpp"
#include "apps/stats/pilot_fit.hpp"
#include "libstudy/store/ratings.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

struct FitCommand {
  std::string database, out, json, svg, exclude = "fail";
  double level = 4;
  apps::PilotSelection selection;
  stats::BootstrapOptions bootstrap;
};

void print_estimate(const char* name, const stats::PilotEstimate& estimate) {
  if (!estimate.fit) {
    std::printf("  %-30s %s\n", name, estimate.fit.reason().c_str());
    return;
  }
  std::printf("  %-30s a = %.2f frames/s", name, estimate.fit->a);
  if (estimate.spread) std::printf(" [%.2f, %.2f]", estimate.spread->a_ci[0], estimate.spread->a_ci[1]);
  std::printf(", b = %.4f s/frame", estimate.fit->b);
  if (estimate.spread) std::printf(" [%.4f, %.4f]", estimate.spread->b_ci[0], estimate.spread->b_ci[1]);
  std::printf("\n");
}

void print_fit(const apps::PilotFit& fit) {
  std::printf(
      "%d participants, %zu ratings of %zu settings\nmu = a exp(b delta) with %.0f %% intervals over "
      "participants:\n",
      fit.participants, fit.data.ratings.size(), fit.settings, 100 * fit.bootstrap.confidence);
  for (const auto& [level, estimate] : fit.harmonic) {
    char name[48];
    std::snprintf(name, sizeof name, "level %.3g, harmonic mean", level);
    print_estimate(name, estimate);
    std::snprintf(name, sizeof name, "level %.3g, arithmetic mean", level);
    print_estimate(name, fit.arithmetic.at(level));
  }
  for (const auto& flag : fit.flags) std::printf("  note: %s\n", flag.text.c_str());
}

/// Outputs that would overwrite the database or each other are refused before anything is read.
void check_outputs(const FitCommand& command) {
  std::map<std::filesystem::path, std::string> taken{
      {std::filesystem::weakly_canonical(command.database), "the database"}};
  for (const auto& [option, path] : std::map<std::string, std::string>{
           {"--out", command.out}, {"--json", command.json}, {"--svg", command.svg}}) {
    if (path.empty()) continue;
    const auto [other, added] = taken.emplace(std::filesystem::weakly_canonical(path), option);
    if (!added)
      throw base::Error(option + " " + path, "is " + other->second, "give each output a file of its own");
  }
}

void write_json(const FitCommand& command, const nlohmann::ordered_json& json) {
  if (!command.json.empty()) base::write_file_atomically(command.json, json.dump(2) + "\n");
}

[[noreturn]] void no_fit(const FitCommand& command, const std::string& reason) {
  throw base::Error(
      command.database, "no fit: " + reason,
      "collect more answers, or choose another --level, --protocol or --exclude; no configuration and "
      "no figure were written");
}

void fit_ptpe(FitCommand& command) {
  check_outputs(command);
  command.selection.exclude = command.exclude == "none"       ? apps::ExcludedVerdicts::None
                              : command.exclude == "degraded" ? apps::ExcludedVerdicts::Degraded
                                                              : apps::ExcludedVerdicts::Fail;
  auto data = apps::select_pilot(study::read_ratings(command.database), command.selection);
  if (!data) {
    write_json(command, apps::failed_fit_json(command.level, data.reason()));
    no_fit(command, data.reason());
  }
  const auto fit = apps::fit_pilot(*data, command.level, command.bootstrap);
  write_json(command, apps::fit_json(fit));
  print_fit(fit);
  if (!fit.ok()) no_fit(command, fit.reason);
  if (!command.svg.empty()) base::write_file_atomically(command.svg, apps::heat_map_svg(fit));
  if (!command.out.empty()) {
    base::write_file_atomically(command.out, sim::format_ptpe_file(apps::ptpe_file(fit)));
  }
}

void add_fit_ptpe(CLI::App& app, FitCommand& command) {
  auto* fit = app.add_subcommand("fit-ptpe", "Fit mu = a exp(b delta) to the ratings of a PTPE pilot");
  auto* positional = fit->add_option("database", command.database, "The study's database");
  fit->add_option("--db", command.database, "The same as an option")->excludes(positional);
  fit->add_option("--level", command.level, "Score of the contour")->capture_default_str();
  fit->add_option("--out", command.out, "Solver's configuration to write (ptpe.toml), on success only");
  fit->add_option("--json", command.json,
                  "Every number of the fit, written whenever the database can be read");
  fit->add_option("--svg", command.svg, "Heat map with contours and curve, on success only");
  fit->add_option("--protocol", command.selection.protocol, "First digits of the protocol's SHA-256");
  fit->add_option("--exclude", command.exclude, "Trials left out by timing verdict")
      ->check(CLI::IsMember({"none", "fail", "degraded"}))
      ->capture_default_str();
  fit->add_option("--resamples", command.bootstrap.resamples, "Bootstrap resamples of the participants")
      ->check(CLI::Range(100, 1000000))
      ->capture_default_str();
  fit->add_option("--seed", command.bootstrap.seed, "Seed of the resamples")->capture_default_str();
  fit->callback([&command] {
    if (command.database.empty()) throw CLI::RequiredError("database or --db");
    if (!std::isfinite(command.level)) throw CLI::ValidationError("--level", "is not a number");
    fit_ptpe(command);
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Statistics of ViP-Lab studies", "vip-stats");
  app.callback([&app] {
    if (app.get_subcommands().empty()) throw CLI::CallForHelp();
  });
  FitCommand command;
  add_fit_ptpe(app, command);
  return apps::run_program(app, argc, argv);
}
