/// vip-stats fit-ptpe: fits the curve mu = a exp(b delta), the just satisfactory frame rate at the standard
/// deviation delta, to the ratings of a pilot study, and writes the file from which the solver reads a and b.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/stats/cell_options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "apps/stats/fit_text.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/ptpe/calibration_history.hpp"
#include "libstudy/analysis/ptpe/fit_shards.hpp"
#include "libstudy/analysis/ptpe/heat_map.hpp"
#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "libstudy/analysis/ptpe/truth.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/new_file.hpp"

namespace apps {

namespace {

struct FitCommand {
  std::string database, out, json, svg, truth, plan;
  std::optional<std::string> exclude;  ///< replaces the plan's rule for timing verdicts
  std::optional<std::uint64_t> seed;   ///< replaces the plan's seed
  /// Largest half width of the curve's confidence band, as a fraction of mu, with which the file for the
  /// solver (--out) is still written.
  double max_width = 0.35;
  bool force = false;
  bool accept_form = false;
  bool incomplete = false;
  std::string lacking;  ///< description of what an incomplete database lacks; empty: complete
  ChoiceOptions choice;
  CellOptions cells;
  stats::AnalysisPlan rules;  ///< the analysis plan, of --plan or the default
  stats::BootstrapOptions bootstrap;

  bool too_wide(const study::PilotFit& fit) const { return !(fit.relative_half_width() <= max_width); }
  /// True if the fit has any doubt that --force overrules: any except form_rejected (the data reject an
  /// exponential), which --accept-form overrules.
  bool doubted(const study::PilotFit& fit) const {
    return std::any_of(fit.doubts.begin(), fit.doubts.end(),
                       [](const auto& doubt) { return doubt.code != stats::form_rejected; });
  }
  bool other_form(const study::PilotFit& fit) const {
    return std::any_of(fit.doubts.begin(), fit.doubts.end(),
                       [](const auto& doubt) { return doubt.code == stats::form_rejected; });
  }
  /// True if a problem of the fit forbids the file for the solver (--out) and no option overrules this
  /// problem.
  bool barred(const study::PilotFit& fit) const {
    return (!force && (too_wide(fit) || doubted(fit))) || (!accept_form && other_form(fit));
  }
};

bool writes_files(const FitCommand& command) {
  return !command.out.empty() || !command.json.empty() || !command.svg.empty();
}

void write_json(const FitCommand& command, base::Json json) {
  if (!command.lacking.empty()) json["incomplete"] = command.lacking;
  if (!command.json.empty()) base::write_file_atomically(command.json, json.dump(2) + "\n");
}

/// Throws the error of a fit that failed. `what`: name of the fit, such as "own pilot 1.0, question
/// "smooth""; empty if none was chosen.
[[noreturn]] void no_fit(const FitCommand& command, const std::string& what, const std::string& reason,
                         const std::string& mend) {
  throw base::Error(command.database,
                    "no fit" + (what.empty() ? "" : " of " + what) + ": " + reason +
                        (writes_files(command) ? "; no configuration and no figure were written" : ""),
                    mend);
}

std::string fitted_name(const study::ChosenTask& chosen) {
  return chosen.protocol.name + " " + chosen.protocol.version + ", question \"" + chosen.question.id + "\"";
}

/// Writes the fit as JSON and prints the fit. If the true model is known (--truth), also reports whether the
/// fit recovered the model.
void report(const FitCommand& command, const study::PilotFit& fit,
            const std::optional<stats::PtpeModel>& truth) {
  auto json = study::fit_json(fit);
  auto refused = base::Json::array();
  for (const auto& doubt : fit.doubts) refused.push_back({{"code", doubt.code}, {"text", doubt.text}});
  json["solver_file"] = {{"max_relative_half_width", command.max_width},
                         {"too_wide", fit.ok() && command.too_wide(fit)},
                         {"refused", refused},
                         {"forced", command.force},
                         {"form_accepted", command.accept_form}};
  std::optional<study::Recovery> recovery;
  if (truth && fit.ok()) recovery = study::check_recovery(fit, *truth);
  if (recovery) json["truth"] = study::recovery_json(*recovery);
  write_json(command, json);
  print_fit(fit);
  if (recovery) std::printf("%s", study::format_recovery(fit, *recovery).c_str());
}

/// Refuses to write the solver's file for a curve that is too uncertain or that the ratings do not support,
/// because such a curve is no calibration.
void refuse_for_solver(const FitCommand& command, const study::PilotFit& fit) {
  if (!command.barred(fit)) return;
  const bool wide = command.too_wide(fit) && !command.force;
  const bool form = command.other_form(fit) && !command.accept_form;
  std::string reasons;
  for (const auto& doubt : fit.doubts) {
    if (doubt.code == stats::form_rejected ? command.accept_form : command.force) continue;
    reasons += (reasons.empty() ? "" : "; ") + doubt.text;
  }
  if (wide) {
    reasons += fmt::format(
        "{}the interval is too wide for a calibration: mu(delta) is uncertain by up to +-{:.0f} %, the limit "
        "is "
        "+-{:.0f} %",
        reasons.empty() ? "" : "; ", 100 * fit.relative_half_width(), 100 * command.max_width);
  }
  std::string mend = "look at the ratings (--svg without --out draws them), collect more participants";
  if (wide) mend += ", set --max-width";
  if (form) mend += ", or accept an exponential as an approximation with --accept-form";
  if (!command.force && (wide || command.doubted(fit)))
    mend += form ? ", and override the rest with --force" : ", or --force";
  throw base::Error(command.database, reasons, mend + "; no configuration and no figure were written");
}

/// Appends a line to the record of calibrations, FILE.history.jsonl, before it writes the file for the solver
/// (--out FILE), so that the record contains every such file. The lock makes simultaneous fits write one
/// after another, so that no line is lost and the last line describes the file that remains.
void hand_to_solver(const FitCommand& command, const study::PilotFit& fit) {
  const base::FileLock lock(command.out);
  const auto text = sim::format_ptpe_file(study::ptpe_file(fit));
  const auto main = fit.main();
  base::Json record{{"database", std::filesystem::path(command.database).filename().string()},
                    {"protocol", fit.data.protocol.name},
                    {"protocol_sha256", fit.data.protocol.sha256},
                    {"estimator", "direct"},
                    {"level", fit.level},
                    {"a", main.fit->a},
                    {"b", main.fit->b},
                    {"a_ci", main.spread->a_ci},
                    {"b_ci", main.spread->b_ci},
                    {"n_participants", fit.participants},
                    {"n_simulated", fit.data.simulated.size()},
                    {"test_data", fit.data.test_data},
                    {"exclude", study::timing_rule_name(command.rules.exclusions.timing)},
                    {"relative_half_width", fit.relative_half_width()},
                    {"max_relative_half_width", command.max_width},
                    {"forced", command.force && (command.too_wide(fit) || command.doubted(fit))},
                    {"form_rejected", command.other_form(fit)},
                    {"version", base::version()}};
  if (!command.lacking.empty()) record["incomplete"] = command.lacking;
  if (!fit.data.imported.empty()) record["imported"] = fit.data.imported;
  study::append_calibration(command.out, text, record);
  base::write_file_atomically(command.out, text);
}

std::string mend_of(const study::PilotFit& fit) {
  if (!fit.level_within_scale()) return study::mend_of_level(fit.data.question);
  return "collect more answers, or choose another --level";
}

void fit_one(const FitCommand& command, const study::TaskStudy& study, const study::ChosenTask& chosen,
             const std::optional<stats::PtpeModel>& truth) {
  const auto data = study::collect_task(study, chosen, command.rules.exclusions);
  const double level =
      study::level_of(command.choice.selection(study::TaskKind::Pilot, command.rules), chosen.question);
  if (const auto nothing = study::nothing_counts(data); !nothing.empty()) {
    write_json(command, study::failed_fit_json(level, nothing));
    no_fit(command, fitted_name(chosen), nothing,
           data.flow.trials_excluded > 0 ? "collect answers, or choose another --exclude or --plan"
                                         : "collect answers");
  }
  const study::FitRequest request{data, level, command.bootstrap, command.rules.pilot};
  if (command.cells.list) return print_cells(study::fit_cells(request));
  if (const auto& key = command.cells.cell; !key.empty())
    return study::run_fit_cell(request, study::find_cell(study::fit_cells(request), key), command.out);
  std::optional<study::FitResamples> drawn;
  if (!command.cells.shards.empty()) drawn = study::join_fit_shards(request, command.cells.shards);
  const auto fit =
      study::fit_pilot(data, level, command.bootstrap, command.rules.pilot, drawn ? &*drawn : nullptr);
  if (truth) study::check_comparable(fit, command.truth);
  report(command, fit, truth);
  if (!fit.ok()) no_fit(command, fitted_name(chosen), fit.reason, mend_of(fit));
  if (!command.out.empty()) refuse_for_solver(command, fit);
  if (!command.svg.empty()) base::write_file_atomically(command.svg, study::heat_map_svg(fit));
  if (!command.out.empty()) hand_to_solver(command, fit);
}

/// The protocols and questions to fit, each separately. If output files or cells are requested, only one fit
/// is allowed.
stats::Result<std::vector<study::ChosenTask>> chosen_pilots(const FitCommand& command,
                                                            const study::TaskStudy& study) {
  const auto selection = command.choice.selection(study::TaskKind::Pilot, command.rules);
  const bool one_fit = writes_files(command) || command.cells.list || !command.cells.shards.empty();
  if (!one_fit) return study::choose_tasks(study, selection);
  const auto one = study::choose_task(study, selection);
  if (!one) return stats::Refusal{one.reason()};
  return std::vector<study::ChosenTask>{*one};
}

void fit_ptpe(FitCommand& command) {
  const auto history = command.out.empty() ? "" : study::history_of(command.out).string();
  const std::map<std::string, std::string> outputs{{"--out", command.out},
                                                   {"the record of --out", history},
                                                   {"--json", command.json},
                                                   {"--svg", command.svg}};
  check_apart(command.database, outputs);
  check_shards_kept(command.cells, outputs);
  std::optional<stats::PtpeModel> truth;
  if (!command.truth.empty()) truth = study::parse_truth(command.truth);
  if (!command.plan.empty()) command.rules = study::read_plan(command.plan).plan;
  command.bootstrap.seed = command.seed.value_or(command.rules.seed);
  command.bootstrap.confidence = command.rules.confidence;
  if (command.exclude) command.rules.exclusions.timing = study::timing_rule_of(*command.exclude);
  const auto study = study::read_tasks({command.database, command.incomplete});
  command.lacking = study.lacking;
  if (!study.lacking.empty())
    std::fprintf(command.cells.list ? stderr : stdout, "incomplete: %s\n", study.lacking.c_str());
  const auto chosen = chosen_pilots(command, study);
  if (!chosen) {
    write_json(command, study::failed_fit_json(command.choice.level, chosen.reason()));
    no_fit(command, "", chosen.reason(),
           study::mend_of_choice(study, command.choice.selection(study::TaskKind::Pilot, command.rules)));
  }
  std::optional<base::Error> failure;  // the first fit that failed; the other fits are still made
  for (const study::ChosenTask& one : *chosen) {
    if (chosen->size() > 1) std::printf("%s:\n", fitted_name(one).c_str());
    try {
      fit_one(command, study, one, truth);
    } catch (const base::Error& error) {
      if (chosen->size() > 1) std::printf("  %s\n", error.what());
      if (!failure) failure = error;
    }
  }
  if (failure) throw *failure;
}

constexpr const char* solver_file =
    "File for the solver (TOML), written on success only; every one is kept in FILE.history.jsonl";

/// Adds the options of the fit and of its results, which `fit-ptpe` and `fit-ptpe merge` share. Returns
/// --out.
CLI::Option* add_fit_options(CLI::App& fit, FitCommand& command, const std::string& out_help) {
  add_incomplete(fit, command.incomplete);
  add_choice(fit, command.choice);
  auto* out = fit.add_option("--out", command.out, out_help)->check(output_file());
  fit.add_option("--max-width", command.max_width,
                 "Widest curve that the solver gets: largest half width of its 95 % band, as a share of mu")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  fit.add_flag("--force", command.force,
               "Write the solver's file although the curve is wider or the ratings do not support it");
  fit.add_flag("--accept-form", command.accept_form,
               "Write the solver's file although the test of the form rejects an exponential curve");
  fit.add_option("--json", command.json,
                 "File for every number of the fit, written whenever the database can be read")
      ->check(output_file());
  fit.add_option("--svg", command.svg,
                 "File for the heat map with contours and curve, written on success only")
      ->check(output_file());
  fit.add_option("--truth", command.truth,
                 "Simulated observer, as given to vip-study run: say whether the intervals hold its a and b");
  fit.add_option("--plan", command.plan,
                 "Analysis plan (TOML) with the rules of exclusion; without: the defaults, as for the tasks");
  fit.add_option("--exclude", command.exclude,
                 "Trials left out by timing verdict, instead of what the plan says (default: fail)")
      ->check(CLI::IsMember({"none", "fail", "degraded"}));
  add_count(fit, "--resamples", command.bootstrap.resamples, 100, 1000000,
            "Bootstrap resamples of the participants");
  fit.add_option("--seed", command.seed, "Seed of the resamples, instead of the plan's (default: 1)");
  return out;
}

}  // namespace

void add_fit_ptpe_command(CLI::App& app) {
  auto command = std::make_shared<FitCommand>();
  auto* fit = app.add_subcommand("fit-ptpe", "Fit mu = a exp(b delta) to the ratings of a PTPE pilot");
  add_database_argument(*fit, command->database);
  auto* out =
      add_fit_options(*fit, *command, std::string(solver_file) + "; with --cell: file of the cell, a shard");
  add_cells(*fit, command->cells, out, {"--json", "--svg"});
  auto* merge = add_merge(*fit, command->cells, command->database,
                          [&](CLI::App& merged) { add_fit_options(merged, *command, solver_file); });
  merge->callback([command] {
    take_database(command->cells, command->database);
    read_shard_names(command->cells);
    fit_ptpe(*command);
  });
  fit->callback([command, merge] {
    if (merge->parsed()) return;
    check_given(command->database);
    fit_ptpe(*command);
  });
}

}  // namespace apps
