/// vip-stats fit-ptpe: from the ratings of a pilot to the solver's file.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/stats/commands.hpp"
#include "apps/stats/heat_map.hpp"
#include "apps/stats/pilot_data.hpp"
#include "apps/stats/pilot_fit.hpp"
#include "apps/stats/truth.hpp"
#include "libstudy/store/ratings.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

struct FitCommand {
  std::string database, out, json, svg, truth, exclude = "fail";
  double level = 4;
  PilotSelection selection;
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

void print_fit(const PilotFit& fit) {
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

/// fit.json, and the same for people; with a truth also whether it was recovered.
void report(const FitCommand& command, const PilotFit& fit, const std::optional<stats::PtpeModel>& truth) {
  auto json = fit_json(fit);
  std::optional<Recovery> recovery;
  if (truth && fit.ok()) recovery = check_recovery(fit, *truth);
  if (recovery) json["truth"] = recovery_json(*recovery);
  write_json(command, json);
  print_fit(fit);
  if (recovery) std::printf("%s", format_recovery(fit, *recovery).c_str());
}

void fit_ptpe(FitCommand& command) {
  check_outputs(command);
  std::optional<stats::PtpeModel> truth;
  if (!command.truth.empty()) truth = parse_truth(command.truth);
  command.selection.exclude = command.exclude == "none"       ? ExcludedVerdicts::None
                              : command.exclude == "degraded" ? ExcludedVerdicts::Degraded
                                                              : ExcludedVerdicts::Fail;
  auto data = select_pilot(study::read_ratings(command.database), command.selection);
  if (!data) {
    write_json(command, failed_fit_json(command.level, data.reason()));
    no_fit(command, data.reason());
  }
  const auto fit = fit_pilot(*data, command.level, command.bootstrap);
  report(command, fit, truth);
  if (!fit.ok()) no_fit(command, fit.reason);
  if (!command.svg.empty()) base::write_file_atomically(command.svg, heat_map_svg(fit));
  if (!command.out.empty()) {
    base::write_file_atomically(command.out, sim::format_ptpe_file(ptpe_file(fit)));
  }
}

}  // namespace

void add_fit_ptpe_command(CLI::App& app) {
  auto command = std::make_shared<FitCommand>();
  auto* fit = app.add_subcommand("fit-ptpe", "Fit mu = a exp(b delta) to the ratings of a PTPE pilot");
  auto* positional = fit->add_option("database", command->database, "The study's database");
  fit->add_option("--db", command->database, "The same as an option")->excludes(positional);
  fit->add_option("--level", command->level, "Score of the contour")->capture_default_str();
  fit->add_option("--out", command->out, "File for the solver (TOML), written on success only");
  fit->add_option("--json", command->json,
                  "File for every number of the fit, written whenever the database can be read");
  fit->add_option("--svg", command->svg,
                  "File for the heat map with contours and curve, written on success only");
  fit->add_option(
      "--truth", command->truth,
      "Simulated observer, as given to vip-study run: say whether the intervals hold its a and b");
  fit->add_option("--protocol", command->selection.protocol, "First digits of the protocol's SHA-256");
  fit->add_option("--question", command->selection.question, "Id of the question, where several are asked");
  fit->add_option("--exclude", command->exclude, "Trials left out by timing verdict")
      ->check(CLI::IsMember({"none", "fail", "degraded"}))
      ->capture_default_str();
  fit->add_option("--resamples", command->bootstrap.resamples, "Bootstrap resamples of the participants")
      ->check(CLI::Range(100, 1000000))
      ->capture_default_str();
  fit->add_option("--seed", command->bootstrap.seed, "Seed of the resamples")->capture_default_str();
  fit->callback([command] {
    if (command->database.empty()) throw CLI::RequiredError("database or --db");
    if (!std::isfinite(command->level)) throw CLI::ValidationError("--level", "is not a number");
    fit_ptpe(*command);
  });
}

}  // namespace apps
