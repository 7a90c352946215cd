/// vip-stats study: results of a study with factors, with the hypotheses that its plan declares.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "apps/common/options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/analysis/tasks/csv.hpp"
#include "libstudy/analysis/tasks/study_results.hpp"
#include "libstudy/report/page.hpp"
#include "libstudy/store/export_register.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace apps {

namespace {

constexpr std::size_t largest_result = std::size_t{1} << 28;

struct StudyCommand {
  std::string database, html, json, csv, plan, bundle, since;
  bool incomplete = false;
  ChoiceOptions choice;

  study::StudyFile file() const { return {database, incomplete}; }
};

study::Json read_since(const std::string& path) {
  try {
    return study::Json::parse(base::read_file(path, largest_result));
  } catch (const base::JsonError& error) {
    throw base::Error(path, std::string("is no JSON: ") + error.what(),
                      "give a file that vip-stats study --json wrote");
  }
}

study::Json results_of_study(const StudyCommand& command) {
  study::FactorStudyRequest request{.database = command.database, .plan = {}};
  if (!command.since.empty()) {
    request.since = read_since(command.since);
    request.since_file = std::filesystem::path(command.since).filename().string();
  }
  const auto study = study::read_tasks(command.file());
  const auto& protocol = study::factor_protocol(study, command.choice.protocol, command.database);
  if (!command.plan.empty()) request.plan = study::read_plan(command.plan, protocol.whole.get());
  if (!request.plan.plan.claims.empty())
    throw base::Error(command.plan, "lists hypotheses with task, which vip-stats study does not test",
                      "remove them here; task1, task2 and report test them");
  if (!command.bundle.empty()) {
    request.frozen = frozen_facts(command.bundle);
    request.plan =
        study::read_plan(std::filesystem::path(command.bundle) / "plan.toml", protocol.whole.get());
  }
  return study::factor_study_json(study, protocol, request);
}

std::string number_or_dash(const study::Json& value, int decimals) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), decimals) : "-";
}

std::string p_words(const study::Json& p) {
  return p.is_number() && p.get<double>() < 0.0001 ? "< .0001" : number_or_dash(p, 4);
}

void print_summary(const study::Json& json) {
  const study::Json& flow = json.at("flow");
  std::printf("%d participants, %d of %d answered trials analysed, %zu exclusions\n",
              flow.at("analysed").get<int>(), flow.at("trials_analysed").get<int>(),
              flow.at("trials_answered").get<int>(), json.at("exclusions").size());
  for (const auto& note : json.at("study").at("notes"))
    std::printf("note: %s\n", note.get<std::string>().c_str());
  if (json.contains("since"))
    std::printf("%d of %zu participants are new since %s\n", json.at("since").at("new").get<int>(),
                json.at("participants").size(), json.at("since").at("file").get<std::string>().c_str());
  if (json.contains("preregistration"))
    for (const auto& problem : json.at("preregistration").at("problems"))
      std::printf("not preregistered: %s\n", problem.get<std::string>().c_str());
  if (json.at("hypotheses").empty()) std::printf("no hypothesis is declared: every result is exploratory\n");
  for (const auto& one : json.at("hypotheses")) {
    const auto reason = one.at("reason").get<std::string>();
    std::printf("%-12s %s: %s against %s, %s: estimate %s, p %s, adjusted %s: %s%s\n",
                one.at("id").get<std::string>().c_str(), one.at("outcome").get<std::string>().c_str(),
                one.at("a").get<std::string>().c_str(), one.at("b").get<std::string>().c_str(),
                one.at("test_name").get<std::string>().c_str(), number_or_dash(one.at("estimate"), 3).c_str(),
                p_words(one.at("p")).c_str(), p_words(one.at("p_adjusted")).c_str(),
                one.at("holds").get<bool>() ? "holds" : "does not hold",
                reason.empty() ? "" : (" (" + reason + ")").c_str());
  }
  if (!json.contains("thresholds")) return;
  for (const auto& track : json.at("thresholds").at("tracks"))
    std::printf("threshold%s: mean %s over %d participants\n",
                track.at("track").get<std::string>().empty()
                    ? ""
                    : (" of " + track.at("track").get<std::string>()).c_str(),
                number_or_dash(track.at("mean"), 2).c_str(), track.at("n").get<int>());
}

void run_study(const StudyCommand& command) {
  check_apart(command.database, {{"--html", command.html}, {"--json", command.json}, {"--csv", command.csv}});
  // The database registers files with people's data, because a withdrawal must delete them. The register is
  // opened before the data are read, and only if a file is to be written.
  std::optional<study::RegisteredFiles> files;
  if (!command.csv.empty() || !command.json.empty() || !command.html.empty()) files.emplace(command.file());
  const study::Json json = results_of_study(command);
  const auto write = [&](const std::filesystem::path& path, const std::string& bytes) {
    files->write("vip-stats study", path, bytes);
  };
  if (!command.csv.empty()) {
    files->make_folder(command.csv);
    for (const auto& [name, list] : study::factor_study_tables(json))
      if (!list.empty()) write(std::filesystem::path(command.csv) / (name + ".csv"), study::csv_text(list));
  }
  if (!command.json.empty()) write(command.json, json.dump(2) + "\n");
  if (!command.html.empty()) write(command.html, study::report::factor_study_page(json));
  print_summary(json);
}

}  // namespace

void add_study_command(CLI::App& app) {
  auto command = std::make_shared<StudyCommand>();
  auto* sub =
      app.add_subcommand("study", "A study with factors: answers by cell, declared tests, thresholds");
  add_database_argument(*sub, command->database);
  add_incomplete(*sub, command->incomplete);
  sub->add_option("--json", command->json, "File for every number (docs/report.md)")->check(output_file());
  sub->add_option("--csv", command->csv, "Folder for the same numbers as tables")->check(output_folder());
  sub->add_option("--html", command->html, "File for a page with the same numbers")->check(output_file());
  auto* plan = sub->add_option(
      "--plan", command->plan,
      "Analysis plan (TOML) with [[hypothesis]], exclusion rules, alpha, confidence; without: the "
      "defaults and no hypothesis");
  sub->add_option(
         "--preregistered", command->bundle,
         "Folder of vip-stats preregister: its plan is used, and its hypotheses count as preregistered "
         "if it is intact, holds the protocol and is older than the first answer")
      ->excludes(plan);
  sub->add_option("--since", command->since,
                  "Earlier --json of this study: marks the participants who are new since then");
  add_protocol_choice(*sub, command->choice);
  sub->footer(std::string("A result that the plan does not declare is called exploratory.\n") +
              registered_files);
  sub->callback([command] {
    check_given(command->database);
    run_study(*command);
  });
}

}  // namespace apps
