/// vip-stats task1 (ratings of realism and cybersickness) and task2 (which of two methods is preferred):
/// print tables, tests and verdicts on the hypotheses.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/tasks/csv.hpp"
#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/store/export_register.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"

namespace apps {

namespace {

struct TaskCommand {
  study::TaskKind task = study::TaskKind::Task1;
  std::string database, json, csv, plan;
  bool incomplete = false;
  ChoiceOptions choice;
};

std::string number_text(const study::Json& value, int decimals) {
  if (!value.is_number()) return value.is_string() ? value.get<std::string>() : "-";
  return fmt::format("{:.{}f}", value.get<double>(), decimals);
}

std::string word(const study::Json& value) { return value.get<std::string>(); }

std::string p_text(const study::Json& p) {
  if (p.is_number() && p.get<double>() < 0.0001) return "< .0001";
  return number_text(p, 4);
}

std::string interval_text(const study::Json& ci) {
  if (!ci.is_array()) return "-";
  const int digits = study::interval_decimals({study::number_of(ci[0]), study::number_of(ci[1])}, 2);
  return "[" + number_text(ci[0], digits) + ", " + number_text(ci[1], digits) + "]";
}

std::string interval_head(const study::Json& json) {
  return fmt::format("{:g} % interval", 100 * json.at("plan").at("confidence").get<double>());
}

/// The length of the longest name, at least `least`. Names are not of fixed length, as a method's name may
/// include a level of effects.
template <class Name>
int width_of(const study::Json& list, int least, const Name& name) {
  for (const auto& one : list) least = std::max(least, static_cast<int>(name(one).size()));
  return least;
}

void print_cells(const study::Json& task, const std::string& interval) {
  const study::Json& cells = task.at("cells");
  const auto width = [&](const char* field, int least) {
    return width_of(cells, least, [&](const study::Json& cell) { return word(cell.at(field)); });
  };
  const int score = width("score", 28), n_star = width("n_star", 5), method = width("method", 9);
  std::printf("\n%-*s %-*s %-*s %4s %7s %6s  %s\n", score, "score", n_star, "n_*", method, "method", "n",
              "mean", "sd", interval.c_str());
  for (const auto& cell : cells)
    std::printf("%-*s %-*s %-*s %4d %7s %6s  %s\n", score, word(cell.at("score")).c_str(), n_star,
                word(cell.at("n_star")).c_str(), method, word(cell.at("method")).c_str(),
                cell.at("n").get<int>(), number_text(cell.at("mean"), 2).c_str(),
                number_text(cell.at("sd"), 2).c_str(), interval_text(cell.at("ci")).c_str());
}

std::string pair_name(const study::Json& pair) { return word(pair.at("a")) + " over " + word(pair.at("b")); }

/// Short name of a pair's test for the table. The printed rules below the table give the full name.
const char* test_word(const study::Json& pair) {
  return pair.contains("by_person") ? "shares" : pair.at("test").is_null() ? "-" : "binomial";
}

/// Prints the names of the kinds of confidence intervals. If there are several kinds, also prints the pairs
/// with each kind.
void print_interval_names(const study::Json& pairs) {
  std::vector<std::pair<std::string, std::string>> names;  // kind of interval, names of its pairs
  for (const auto& pair : pairs) {
    const bool people = pair.contains("by_person");
    if (!people && !pair.at("clopper_pearson").is_array()) continue;
    const std::string name = people ? word(pair.at("by_person").at("ci_name")) : "Clopper-Pearson";
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const auto& one) { return one.first == name; });
    if (found == names.end())
      names.emplace_back(name, pair_name(pair));
    else
      found->second += ", " + pair_name(pair);
  }
  for (const auto& [name, of] : names)
    std::printf("interval%s: %s\n", names.size() == 1 ? "s" : (" of " + of).c_str(), name.c_str());
}

void print_pairs(const study::Json& task, const std::string& interval) {
  const int width = width_of(task.at("pairs"), 22, pair_name);
  std::printf("\n%-*s %4s %4s %6s %8s %8s  %-16s %s\n", width, "chosen", "k", "n", "share", "p", "Holm",
              interval.c_str(), "test");
  std::string notes;
  for (const auto& pair : task.at("pairs")) {
    const bool people = pair.contains("by_person");
    const study::Json& share = people ? pair.at("by_person").at("share") : pair.at("share");
    const study::Json& ci = people ? pair.at("by_person").at("ci") : pair.at("clopper_pearson");
    std::printf("%-*s %4d %4d %6s %8s %8s  %-16s %s\n", width, pair_name(pair).c_str(),
                pair.at("k").get<int>(), pair.at("n").get<int>(), number_text(share, 2).c_str(),
                p_text(pair.at("p")).c_str(), p_text(pair.at("p_holm")).c_str(), interval_text(ci).c_str(),
                test_word(pair));
    const std::string note =
        word(pair.at("warning")).empty() ? word(pair.at("reason")) : word(pair.at("warning"));
    if (!note.empty()) notes += pair_name(pair) + ": " + note + "\n";
  }
  print_interval_names(task.at("pairs"));
  const study::Json& several = task.at("several_answers");
  if (several.at("participants").get<int>() > 0)
    std::printf("%d of %d participants answered a pair more than once, at most %d times.\n",
                several.at("participants").get<int>(), several.at("of").get<int>(),
                several.at("most").get<int>());
  for (const char* rule : {"tests", "more_than_one_trial"})
    if (task.at("rules").contains(rule)) std::printf("%s\n", word(task.at("rules").at(rule)).c_str());
  std::printf("%s", notes.c_str());
  if (task.at("triads").contains("refused"))
    std::printf("Circular triads are not given: %s.\n", word(task.at("triads").at("refused")).c_str());
}

void print_test(const study::Json& test) {
  const bool holds = test.at("holds").get<bool>(), against = test.at("against").get<bool>();
  std::printf("    %-36s %8s  p %-8s Holm %-8s %s\n", word(test.at("label")).c_str(),
              number_text(test.at("estimate"), 3).c_str(), p_text(test.at("p")).c_str(),
              p_text(test.at("p_holm")).c_str(),
              holds     ? "holds"
              : against ? "significant in the other direction"
                        : word(test.at("reason")).c_str());
}

void print_hypotheses(const study::Json& json) {
  for (const auto& one : json.at("hypotheses")) {
    std::printf("\n%s %s\n  %s. %s\n", word(one.at("id")).c_str(), word(one.at("title")).c_str(),
                word(one.at("status")).c_str(), word(one.at("status_text")).c_str());
    if (one.contains("paper"))
      std::printf("  By the paper's rule (%s): %s\n", word(one.at("paper").at("rule")).c_str(),
                  word(one.at("paper").at("text")).c_str());
    for (const auto& test : one.at("tests")) print_test(test);
  }
}

/// Prints the protocol's name, because a database may contain several protocols of a task, which are analysed
/// separately.
void print_name(const study::Json& json) {
  const study::Json& protocol = json.at("study").at("protocols").at(0);
  std::printf("protocol %s %s, SHA-256 %.12s\n", word(protocol.at("name")).c_str(),
              word(protocol.at("version")).c_str(), word(protocol.at("sha256")).c_str());
}

void print_results(const study::Json& json, study::TaskKind task) {
  if (json.at("study").contains("incomplete"))
    std::printf("incomplete: %s\n", word(json.at("study").at("incomplete")).c_str());
  const study::Json& flow = json.at("flow").at(study::task_name(task));
  std::printf("%d participants, %d of %d answered trials analysed, %zu exclusions\n",
              flow.at("analysed").get<int>(), flow.at("trials_analysed").get<int>(),
              flow.at("trials_answered").get<int>(), json.at("exclusions").size());
  for (const auto& note : json.at("study").at("notes")) std::printf("note: %s\n", word(note).c_str());
  for (const auto& one : json.at("not_analysed"))
    std::printf("not analysed: %s: %s\n", word(one.at("what")).c_str(), word(one.at("reason")).c_str());
  const study::Json& part = json.at(study::task_name(task));
  task == study::TaskKind::Task1 ? print_cells(part, interval_head(json))
                                 : print_pairs(part, interval_head(json));
  print_hypotheses(json);
  for (const auto& variant : json.at("sensitivity")) {
    std::string changes;
    if (variant.contains("changed")) {
      for (const auto& id : variant.at("changed")) changes += " " + word(id);
    }
    if (word(variant.at("id")) == "planned") continue;
    std::printf("\n%s: %s", word(variant.at("label")).c_str(),
                variant.contains("refused") ? word(variant.at("refused")).c_str()
                : changes.empty()           ? "same verdicts"
                                            : ("other verdicts on" + changes).c_str());
  }
  std::printf("\n");
}

void run(const TaskCommand& command) {
  check_apart(command.database, {{"--json", command.json}});
  if (command.choice.level)
    throw base::Error("--level", std::string("does not apply to ") + study::task_name(command.task),
                      "leave it out: it applies to the curve of a pilot");
  study::ResultsRequest request;
  request.database = command.database;
  request.tasks = {command.task};
  request.protocol = command.choice.protocol;
  request.question = command.choice.question;
  request.level = command.choice.level;
  request.incomplete = command.incomplete;
  if (!command.plan.empty()) request.plan = study::read_plan(command.plan);
  // The database registers files with people's data, because a withdrawal must delete them. The register is
  // opened before the data are read, and only if a file is to be written.
  std::optional<study::RegisteredFiles> files;
  if (!command.json.empty() || !command.csv.empty())
    files.emplace(study::StudyFile(command.database, command.incomplete));
  const auto write = [&](const std::filesystem::path& path, const std::string& bytes) {
    files->write(std::string("vip-stats ") + study::task_name(command.task), path, bytes);
  };
  const study::Results results = study::study_results(request);
  if (!results.missing.empty()) {
    throw base::Error(command.database, results.missing.front().reason + "; nothing was written",
                      results.missing.front().mend);
  }
  if (!command.json.empty()) write(command.json, results.json.dump(2) + "\n");
  if (!command.csv.empty()) {
    for (const auto& folder : study::csv_folders(results.json, command.csv)) files->make_folder(folder);
    study::write_csv_folder(results.json, command.csv, write);
  }
  const study::Json apart = results.json.value("apart", study::Json::array());
  if (!apart.empty()) print_name(results.json);
  print_results(results.json, command.task);
  for (const auto& one : apart) {
    std::printf("\n");
    print_name(one);
    print_results(one, command.task);
  }
}

void add_command(CLI::App& app, study::TaskKind task, const char* what) {
  auto command = std::make_shared<TaskCommand>();
  command->task = task;
  auto* sub = app.add_subcommand(study::task_name(task), what);
  add_database_argument(*sub, command->database);
  add_incomplete(*sub, command->incomplete);
  sub->add_option("--json", command->json, "File for every number (docs/report.md)")->check(output_file());
  sub->add_option("--csv", command->csv, "Folder for the same numbers as tables")->check(output_folder());
  add_plan(*sub, command->plan);
  add_choice(*sub, command->choice);
  sub->footer(registered_files);
  sub->callback([command] {
    check_given(command->database);
    run(*command);
  });
}

}  // namespace

void add_task_commands(CLI::App& app) {
  add_command(app, study::TaskKind::Task1,
              "Realism and cybersickness of the methods, and the hypotheses about them");
  add_command(app, study::TaskKind::Task2,
              "Which of two methods is preferred, and the hypotheses about that");
}

}  // namespace apps
