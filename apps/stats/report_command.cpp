/// vip-stats report: writes a study's results as one HTML page, and the same numbers as JSON and CSV.

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/common/options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/analysis/tasks/csv.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/analysis/tasks/sickness_json.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/report/page.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"

namespace apps {

namespace {

struct ReportCommand {
  std::string database, html, json, csv, plan, bundle, sweep;
  bool incomplete = false;
  ChoiceOptions choice;

  study::StudyFile file() const { return {database, incomplete}; }
};

constexpr std::array all_tasks{study::TaskKind::Pilot, study::TaskKind::Task1, study::TaskKind::Task2,
                               study::TaskKind::Own};

void add_preregistration(study::Json& json, const study::report::Bundle& bundle,
                         const std::vector<study::ProtocolRow>& protocols) {
  json["preregistration"] = study::report::compare_with_bundle(bundle, protocols, json);
  if (!json.contains("apart")) return;
  for (study::Json& one : json["apart"])
    one["preregistration"] = study::report::compare_with_bundle(bundle, protocols, one);
}

/// Refuses --level in a study without a pilot, and a level outside a question's scale, as fit-ptpe does.
void check_level(const ReportCommand& command, const study::TaskStudy& study,
                 const stats::AnalysisPlan& plan) {
  const auto pilots = study::choose_tasks(study, command.choice.selection(study::TaskKind::Pilot, plan));
  if (!pilots)
    throw base::Error("--level", "does not apply here: " + pilots.reason(),
                      "leave it out: it applies to the curve of a pilot");
  for (const study::ChosenTask& one : *pilots) {
    if (study::within_scale(*command.choice.level, one.question)) continue;
    throw base::Error(command.database,
                      study::outside_scale(*command.choice.level, one.question) + "; nothing was written",
                      study::mend_of_level(one.question));
  }
}

study::Json document(const ReportCommand& command) {
  study::ResultsRequest request;
  request.database = command.database;
  request.tasks.assign(all_tasks.begin(), all_tasks.end());
  request.protocol = command.choice.protocol;
  request.question = command.choice.question;
  request.level = command.choice.level;
  if (!command.sweep.empty()) {
    request.sweep = std::make_shared<const study::SweepTables>(study::read_sweep_tables(command.sweep));
    request.sweep_file = std::filesystem::path(command.sweep).filename().string();
  }
  std::optional<study::report::Bundle> bundle;
  if (!command.bundle.empty()) {
    bundle = study::report::read_bundle(command.bundle);
    request.plan = bundle->plan;
  } else if (!command.plan.empty()) {
    request.plan = study::read_plan(command.plan);
  }
  auto study = study::read_tasks(command.file());
  study::read_about_people(command.file(), study);
  if (command.choice.level) check_level(command, study, request.plan.plan);
  study::Results results = study::make_results(study, request);
  if (results.json.at("flow").empty()) {
    std::string mend;
    const std::string reason = study::nothing_chosen(study, command.choice.protocol, mend).reason;
    throw base::Error(command.database, reason + "; nothing was written", mend);
  }
  study::Json sickness = study::sickness_json(study::read_sickness(command.file()), request.plan.plan);
  if (!sickness.empty()) results.json["sickness"] = std::move(sickness);
  if (bundle) add_preregistration(results.json, *bundle, study::read_status(command.file()).protocols);
  return results.json;
}

void write_report(const ReportCommand& command) {
  check_apart(command.database, {{"--html", command.html}, {"--json", command.json}, {"--csv", command.csv}});
  const study::RegisteredFiles files(command.file());
  const study::Json json = document(command);
  const std::string page = command.html.empty() ? "" : study::report::results_page(json);
  const auto write = [&](const std::filesystem::path& path, const std::string& bytes) {
    files.write("vip-stats report", path, bytes);
  };
  if (!command.csv.empty()) {
    for (const auto& folder : study::csv_folders(json, command.csv)) files.make_folder(folder);
    study::write_csv_folder(json, command.csv, write);
  }
  if (!command.json.empty()) write(command.json, json.dump(2) + "\n");
  if (!command.html.empty()) {
    write(command.html, page);
    std::printf("%s: %zu kB\n", command.html.c_str(), page.size() / 1000);
  }
  if (json.contains("preregistration")) {
    const study::Json& check = json["preregistration"];
    std::printf("%s\n", check["summary"].get<std::string>().c_str());
    for (const auto& difference : check["differences"])
      std::printf("  %s\n", difference.get<std::string>().c_str());
  }
}

}  // namespace

void add_report_command(CLI::App& app) {
  auto command = std::make_shared<ReportCommand>();
  auto* sub = app.add_subcommand("report", "One page with every table, figure, test and decision of a study");
  add_database_argument(*sub, command->database);
  add_incomplete(*sub, command->incomplete);
  sub->add_option("--html", command->html, "File for the page")->check(output_file());
  sub->add_option("--json", command->json, "File for every number of the page (docs/report.md)")
      ->check(output_file());
  sub->add_option("--csv", command->csv, "Folder for the same numbers as tables")->check(output_folder());
  sub->add_option(
      "--sweep", command->sweep,
      "Sweep file of vip-bench accuracy: adds the cost and error of each method's setting to the answers");
  add_choice(*sub, command->choice);
  auto* plan = add_plan(*sub, command->plan);
  sub->add_option("--preregistered", command->bundle,
                  "Folder of vip-stats preregister: its plan is used, and the page says what differs from it")
      ->excludes(plan);
  sub->footer(
      "All of it is the lab's own: it is made of everybody's data, also of those who refused to share it.\n"
      "The files hold values of single participants, so only their owner may read them (0600), and they are\n"
      "registered in the database, which must be writable for that: when one of them withdraws, the files "
      "are\n"
      "deleted, to be made again.");
  sub->callback([command] {
    check_given(command->database);
    if (command->html.empty() && command->json.empty() && command->csv.empty())
      throw CLI::RequiredError("--html, --json or --csv");
    write_report(*command);
  });
}

}  // namespace apps
