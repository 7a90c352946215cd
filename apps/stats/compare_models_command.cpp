/// vip-stats compare-models: which property of the frame timing predicts the answers of people.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "apps/common/options.hpp"
#include "apps/stats/cell_options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/rivals/rival_shards.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

struct CompareCommand {
  std::string database, json, plan, bundle, models, out;
  std::optional<std::string> exclude;
  std::optional<std::uint64_t> seed;
  int folds = 0;
  bool folds_given = false;
  bool incomplete = false;
  ChoiceOptions choice;
  CellOptions cells;

  study::StudyFile file() const { return {database, incomplete}; }
};

double real(const study::Json& json, const char* key) { return json.at(key).get<double>(); }
std::string words(const study::Json& json, const char* key) { return json.at(key).get<std::string>(); }

void print_head(const study::Json& json) {
  std::printf("%s, question \"%s\": %d people, %d answers to %d timings\n",
              words(json.at("protocol"), "name").c_str(), words(json, "question").c_str(),
              json.at("people").get<int>(), json.at("answers").get<int>(), json.at("settings").get<int>());
  const std::string exploratory = words(json, "why_exploratory");
  if (!exploratory.empty())
    std::printf("exploratory: %s\n", exploratory.c_str());
  else
    std::printf("confirmatory: %s declares this comparison and was frozen before the first answer\n",
                words(json.at("plan"), "source").c_str());
  if (json.at("test_data").get<bool>()) std::printf("note: these are test data, not a study\n");
  if (const int n = json.at("simulated_participants").get<int>(); n > 0)
    std::printf("note: %d participants are simulated\n", n);
  const auto& left_out = json.at("left_out");
  if (const int n = left_out.at("excluded").get<int>(); n > 0)
    std::printf("note: %d answers are left out by rule or by hand\n", n);
  for (const auto& [reason, n] : left_out.at("without_frames").items())
    std::printf("note: %d answers are left out: %s\n", n.get<int>(), reason.c_str());
}

void print_models(const study::Json& json) {
  const bool alone = json.at("folds") == json.at("people");
  std::printf("\nlog score of people whom the fit did not see (%s); +- one standard error over people\n",
              alone ? "each left out in turn"
                    : fmt::format("in {} groups, seed {}", json.at("folds").get<int>(),
                                  json.at("seed").get<std::uint64_t>())
                          .c_str());
  std::printf("  %-24s %10s %18s %7s %6s %6s  %s\n", "model", "log score", "behind the best", "weight",
              "lapse", "people", "b");
  for (const auto& one : json.at("models")) {
    const std::string name = words(one, "name");
    if (one.contains("refused")) {
      std::printf("  %-24s left out: %s\n", name.c_str(), words(one, "refused").c_str());
      continue;
    }
    const bool best = real(one, "behind") == 0 && real(one, "behind_se") == 0;
    std::printf(
        "  %-24s %10.1f %18s %7s %6.3f %6.2f  %s\n", name.c_str(), real(one, "log_score"),
        best ? "-" : fmt::format("{:.1f} +- {:.1f}", -real(one, "behind"), real(one, "behind_se")).c_str(),
        one.contains("weight") ? fmt::format("{:.2f}", real(one, "weight")).c_str() : "-", real(one, "lapse"),
        real(one, "sd_person"), one.contains("b") ? fmt::format("{:.4g}", real(one, "b")).c_str() : "");
  }
  std::printf(
      "  weight: of the best mixture (stacking). lapse: share of guesses. people: SD between people.\n"
      "  nothing: no predictor. free: a value for each timing; it is no rival.\n");
}

void print_collinear(const study::Json& json) {
  const auto& running = json.at("proposals").at("between");
  std::printf("\nR2 of a model's predictor, fitted by another model over the timings shown\n");
  for (const auto& one : json.at("collinear")) {
    const auto in = [&](const char* key) {
      return std::find(running.begin(), running.end(), one.at(key)) != running.end();
    };
    if (in("predictor_of") && in("by"))
      std::printf("  %s by %s: %.4f\n", words(one, "predictor_of").c_str(), words(one, "by").c_str(),
                  real(one, "r2"));
  }
}

void print_calibration(const study::Json& json) {
  const std::string best = json.at("verdict").at("in_the_running").at(0).get<std::string>();
  std::printf("\ncalibration of %s: answers by the score that it predicts\n  %8s %8s %10s %18s\n",
              best.c_str(), "score", "answers", "predicted", "observed");
  for (const auto& model : json.at("models")) {
    if (model.at("name") != best) continue;
    for (const auto& bin : model.at("calibration"))
      std::printf("  %8d %8d %10.2f %18s\n", bin.at("score").get<int>(), bin.at("answers").get<int>(),
                  real(bin, "predicted"),
                  fmt::format("{:.2f} +- {:.2f}", real(bin, "observed"), real(bin, "se")).c_str());
  }
}

void print_proposals(const study::Json& json) {
  const auto& proposals = json.at("proposals");
  if (!proposals.contains("tried")) return;
  std::string names;
  for (const auto& one : proposals.at("between"))
    names += (names.empty() ? "" : ", ") + one.get<std::string>();
  std::printf("\ntimings at which %s differ most (mean score by each; nats that one answer tells)\n",
              names.c_str());
  for (const auto& one : proposals.at("timings")) {
    std::string scores;
    for (const auto& score : one.at("scores")) scores += fmt::format(" {:5.2f}", score.get<double>());
    std::printf("  %.4f %s  %s\n", real(one, "information"), scores.c_str(), words(one, "words").c_str());
    if (words(one, "timing").size() < 100) std::printf("         %s\n", words(one, "timing").c_str());
    if (one.contains("pacing")) std::printf("         [pacing] %s\n", words(one, "pacing").c_str());
  }
  if (proposals.at("timings").empty())
    std::printf("  none: at every timing tried a predictor lies beyond what was shown\n");
  std::printf("  %d of %d timings tried were left out, because a predictor lies beyond what was shown.\n",
              proposals.at("beyond_what_was_shown").get<int>(), proposals.at("tried").get<int>());
}

void compare_models(const CompareCommand& command) {
  check_apart(command.database, {{"--json", command.json}, {"--plan", command.plan}, {"--out", command.out}});
  check_shards_kept(command.cells, {{"--json", command.json}});
  study::PlanInForce in_force;
  const std::string plan_file =
      command.bundle.empty() ? command.plan : (std::filesystem::path(command.bundle) / "plan.toml").string();
  std::optional<study::FrozenFacts> frozen;
  if (!command.bundle.empty()) frozen = frozen_facts(command.bundle);
  if (!plan_file.empty()) in_force = study::read_plan(plan_file);
  stats::AnalysisPlan& plan = in_force.plan;
  const bool plan_rules = !command.exclude && !command.seed;
  if (command.exclude) plan.exclusions.timing = study::timing_rule_of(*command.exclude);
  const auto& declared = plan.comparison;
  const auto models = !command.models.empty() ? study::parse_timing_models(command.models)
                      : declared              ? study::timing_models(declared->models, plan_file)
                                              : study::usual_timing_models();
  ChoiceOptions choice = command.choice;
  if (declared && choice.question.empty()) choice.question = declared->question;
  const int folds = declared && !command.folds_given ? declared->folds : command.folds;
  const auto study = study::read_tasks(command.file());
  if (!study.lacking.empty())
    std::fprintf(command.cells.list ? stderr : stdout, "incomplete: %s\n", study.lacking.c_str());
  std::string mend;
  const auto chosen = study::choose_rated_task(study, choice.selection(study::TaskKind::Pilot, plan), mend);
  if (!chosen) throw base::Error(command.database, "no comparison: " + chosen.reason(), mend);
  const auto data = study::collect_rival_data(command.file(), study, *chosen, plan.exclusions);
  if (const auto reason = study::why_no_comparison(data, mend); !reason.empty())
    throw base::Error(command.database, "no comparison: " + reason, mend);
  if (const auto reason = study::why_not_recorded(data, models, mend); !reason.empty())
    throw base::Error(command.database, "no comparison: " + reason, mend);
  if (folds > data.answers.people)
    throw base::Error((command.folds_given ? "--folds " : plan_file + ", folds = ") + std::to_string(folds),
                      "there are only " + std::to_string(data.answers.people) + " people",
                      command.folds_given
                          ? "give at most as many groups, or leave it out"
                          : "give --folds with at most as many groups; the result is then exploratory");
  const stats::RivalComparisonOptions options{folds, command.seed.value_or(plan.seed), {}};
  if (command.cells.list) return print_cells(study::rival_cells(data, models, options));
  if (const auto& key = command.cells.cell; !key.empty())
    return study::run_rival_cell(
        data, models, options, study::find_cell(study::rival_cells(data, models, options), key), command.out);
  std::optional<study::RivalFits> without;
  if (!command.cells.shards.empty())
    without = study::join_rival_shards(data, models, options, command.cells.shards);
  const auto comparison = study::compare_timing_models(data, models, options, without ? &*without : nullptr);
  if (!comparison)
    throw base::Error(command.database, "no comparison: " + comparison.reason(),
                      "choose other --models, or collect more answers");
  const auto exploratory = study::why_exploratory(data, models, options, plan_rules, in_force, frozen);
  auto json = study::compare_models_json(data, models, options, *comparison, in_force, exploratory);
  if (frozen) json["preregistration"] = study::preregistration_json(*frozen, data.task);
  if (!study.lacking.empty()) json["incomplete"] = study.lacking;
  if (!command.json.empty()) base::write_file_atomically(command.json, json.dump(2) + "\n");
  print_head(json);
  print_models(json);
  std::printf("\n%s.\n", words(json.at("verdict"), "text").c_str());
  print_collinear(json);
  print_calibration(json);
  print_proposals(json);
}

/// Adds the options of the calculation and of its results, which `compare-models` and `compare-models merge`
/// share. Returns --folds.
CLI::Option* add_compare_options(CLI::App& sub, CompareCommand& command) {
  add_incomplete(sub, command.incomplete);
  add_protocol_choice(sub, command.choice);
  sub.add_option("--question", command.choice.question, "Id of the question; needed if several are rated");
  sub.add_option(
      "--models", command.models,
      "Models, separated by commas: ptpe, mean_rate, arithmetic_rate, rate_sd, frame_time_sd, p95, "
      "p99, longest, hitches, steps, animation_error, or two of these joined by '+'; without: the usual "
      "eight");
  auto* folds = add_count(sub, "--folds", command.folds, 0, 1000,
                          "Groups of people that are left out in turn; 0: each person by themselves");
  sub.add_option("--seed", command.seed, "Seed of the groups, instead of the plan's (default: 1)");
  sub.add_option("--json", command.json, "File for every number (docs/statistics.md)")->check(output_file());
  auto* plan = sub.add_option(
      "--plan", command.plan,
      "Analysis plan (TOML) with the rules of exclusion and, as [model_comparison], the question and "
      "the models; without: the defaults");
  sub.add_option("--preregistered", command.bundle,
                 "Folder of vip-stats preregister: its plan is used, and the comparison that it declares is "
                 "confirmatory if it is intact, holds the protocol and is older than the first answer")
      ->excludes(plan);
  sub.add_option("--exclude", command.exclude,
                 "Trials left out by timing verdict, instead of what the plan says (default: fail)")
      ->check(CLI::IsMember({"none", "fail", "degraded"}));
  return folds;
}

void compare_with(CompareCommand& command, const CLI::Option& folds) {
  command.folds_given = folds.count() > 0;
  check_given(command.database);
  if (command.folds == 1)
    throw base::Error("--folds 1", "leaves nobody to fit", "give 0, or 2 and more groups");
  compare_models(command);
}

}  // namespace

void add_compare_models_command(CLI::App& app) {
  auto command = std::make_shared<CompareCommand>();
  auto* sub = app.add_subcommand("compare-models",
                                 "Which property of the frame timing predicts people's answers best");
  add_database_argument(*sub, command->database);
  auto* folds = add_compare_options(*sub, *command);
  auto* out = sub->add_option("--out", command->out, "File of --cell, a shard")->check(output_file());
  add_cells(*sub, command->cells, out, {"--json"});
  out->needs("--cell");
  CLI::Option* merged_folds = nullptr;
  auto* merge = add_merge(*sub, command->cells, command->database,
                          [&](CLI::App& merged) { merged_folds = add_compare_options(merged, *command); });
  merge->callback([command, merged_folds] {
    take_database(command->cells, command->database);
    read_shard_names(command->cells);
    compare_with(*command, *merged_folds);
  });
  sub->callback([command, merge, folds] {
    if (!merge->parsed()) compare_with(*command, *folds);
  });
}

}  // namespace apps
