/// vip-stats power: the power of a study with n participants, from simulated studies of its protocol.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "apps/stats/cell_options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "apps/stats/power_text.hpp"
#include "libstudy/power/power_figure.hpp"
#include "libstudy/power/shard.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

struct PowerCommand {
  std::string protocol, n, plan, observer, answers = "likert", earlier;
  std::optional<double> person_by_method;
  std::string json, csv, svg, out;
  ChoiceOptions choice;
  CellOptions cells;
  study::PowerRequest request;
  int studies = 0;
};

void refuse(const std::string& option, const std::string& problem, const std::string& mend) {
  throw base::Error(option, problem, mend);
}

/// Refuses options that do not apply to this kind of protocol. For Task 2, also refuses a preference outside
/// (0, 1), and a design whose repeated pairs the plan refuses to test.
void check_kind(const study::PowerRequest& request, study::PowerKind kind, const CLI::App& options) {
  const auto only = [&](const char* option, bool fits, const char* where) {
    if (options.count(option) > 0 && !fits)
      refuse(option, "does not apply to protocol " + request.protocol.name,
             std::string("leave it out: it is for ") + where);
  };
  const bool task1 = kind == study::PowerKind::Task1, task2 = kind == study::PowerKind::Task2,
             pilot = kind == study::PowerKind::Pilot;
  for (const char* option :
       {"--difference", "--sd", "--sd-sickness", "--person-by-method", "--earlier", "--answers"})
    only(option, task1, "Task 1");
  only("--interval-bias", task2, "Task 2");
  for (const char* option : {"--effect", "--world"}) only(option, !pilot, "Task 1 and Task 2");
  for (const char* option : {"--precision-a", "--precision-b", "--observer", "--question", "--level"})
    only(option, pilot, "the pilot");
  const auto& design = request.protocol.design;
  if (task2 && design.groups > 1 && design.effects.empty() &&
      request.plan.plan.repeated_pairs == stats::RepeatedPairs::Refuse)
    refuse(
        "protocol " + request.protocol.name,
        "shows each pair to a participant in " + std::to_string(design.groups) +
            " scenes, and the plan refuses tests of a pair with several answers of one person: no test could "
            "ever succeed",
        "write more_than_one_trial = \"share\" into a plan and give it with --plan, or groups = 1 into the "
        "protocol");
  if (task2 && request.effect && !(*request.effect > 0 && *request.effect < 1))
    refuse(fmt::format("--effect {:g}", *request.effect),
           "is a preference in Task 2, which lies above 0 and below 1", "write for example --effect 0.7");
}

void complete(PowerCommand& command, const CLI::App& options) {
  if (command.protocol.empty()) throw CLI::RequiredError("protocol");
  study::PowerRequest& request = command.request;
  if (!command.plan.empty()) request.plan = study::read_plan(command.plan);
  request.protocol = study::read_protocol(study::find_protocol(command.protocol));
  request.file = command.protocol;
  const study::PowerKind kind = study::power_kind(request.protocol, request.plan.plan);
  request.question = command.choice.question;
  request.level = command.choice.level;
  check_kind(request, kind, options);
  request.n =
      command.n.empty() ? std::vector{request.protocol.participants} : study::parse_participants(command.n);
  // Default number of simulated studies for each n. More than 12 values of n halve the number, to limit the
  // time.
  const bool many = request.n.size() > 12;
  const int usual_studies = many ? 1000 : 2000, usual_pilots = many ? 200 : 400;
  request.studies = command.studies > 0               ? command.studies
                    : kind == study::PowerKind::Pilot ? usual_pilots
                                                      : usual_studies;
  request.answers = command.answers == "likert" ? study::AnswerScale::Likert : study::AnswerScale::Continuous;
  if (!command.observer.empty()) request.observer = study::parse_ptpe_observer(command.observer);
  if (command.person_by_method)
    request.person_by_method = {*command.person_by_method, *command.person_by_method};
  if (!command.earlier.empty()) request.person_by_method = study::person_by_method_of(command.earlier);
  if (kind == study::PowerKind::Pilot) return;
  if (request.worlds.empty()) {
    request.worlds = {"null", "margin", "paper"};
    if (request.effect || request.difference) request.worlds.insert(request.worlds.begin(), "effect");
    // A world is a truth that simulated studies assume. In Task 2 the world "margin" equals "null". In Task 1
    // the differences of "margin" fit only the shipped hypotheses. So "margin" is omitted in Task 2 and for
    // plans with claims of their own.
    if (kind == study::PowerKind::Task2 || !request.plan.plan.claims.empty())
      std::erase(request.worlds, "margin");
    if (!request.protocol.design.effects.empty())
      std::erase(request.worlds, "paper");  // the paper varies no effects
    return;
  }
  std::vector<std::string> unique;
  for (const auto& one : request.worlds) {
    if (std::find(unique.begin(), unique.end(), one) == unique.end()) unique.push_back(one);
  }
  // --effect or --difference adds the world "effect", the assumed truth that these options describe.
  if ((request.effect || request.difference) &&
      std::find(unique.begin(), unique.end(), "effect") == unique.end())
    unique.insert(unique.begin(), "effect");
  request.worlds = unique;
}

/// Makes the texts of all files before it writes the first file, so that an error in making a text leaves no
/// file.
void write_files(const PowerCommand& command, const study::Json& json) {
  const std::string text = command.json.empty() ? "" : json.dump(2) + "\n";
  const std::string table = command.csv.empty() ? "" : study::power_csv(json);
  const std::string picture = command.svg.empty() ? "" : study::power_svg(json);
  if (!text.empty()) base::write_file_atomically(command.json, text);
  if (!table.empty()) base::write_file_atomically(command.csv, table);
  if (!picture.empty()) base::write_file_atomically(command.svg, picture);
}

void write_and_print(const PowerCommand& command, const study::StudyOutcomes& outcomes) {
  const study::Json json = study::power_json(command.request, outcomes);
  write_files(command, json);
  print_power(command.request, json);
}

void check_outputs(const PowerCommand& command) {
  const std::map<std::string, std::string> outputs{
      {"--json", command.json}, {"--csv", command.csv}, {"--svg", command.svg}, {"--out", command.out}};
  check_apart("", outputs);
  check_shards_kept(command.cells, outputs);
  check_kept(command.earlier, "holds the results that --earlier reads", outputs);
}

void run_power(PowerCommand& command, const CLI::App& options) {
  check_outputs(command);
  complete(command, options);
  const study::PowerRequest& request = command.request;
  if (command.cells.list) {
    print_cells(study::power_cells(request));
  } else if (const auto& key = command.cells.cell; !key.empty()) {
    study::run_cell(request, study::find_cell(study::power_cells(request), key), command.out);
  } else {
    write_and_print(command, study::simulate_studies(request, {0, request.studies}));
  }
}

void merge(PowerCommand& command, const CLI::App& options) {
  read_shard_names(command.cells);
  check_outputs(command);
  complete(command, options);
  write_and_print(command, study::join_shards(command.request, command.cells.shards));
}

/// Adds the options of the calculation and of its output files, which `power` and `power merge` share.
void add_request_options(CLI::App& sub, PowerCommand& command) {
  study::PowerRequest& request = command.request;
  sub.add_option("protocol", command.protocol,
                 "Protocol file, or the name of one that comes with the program, such as task1");
  sub.add_option("--n", command.n,
                 "Participants: LOW:HIGH, LOW:HIGH:STEP or one number; without: the protocol's");
  sub.add_option(
         "--effect", request.effect,
         "Task 2: true preference of the better method, or of a level of effects over none; Task 1: true "
         "difference in standard deviations of the differences")
      ->check(number_in(-10, 10));
  auto* difference = sub.add_option("--difference", request.difference,
                                    "Task 1: the same in points of realism; cybersickness in proportion")
                         ->check(number_in(-6, 6));
  difference->excludes("--effect");
  sub.add_option("--sd", request.sd_realism, "Task 1: SD of a person's difference in realism, points")
      ->capture_default_str()
      ->check(number_in(0.01, 10));
  sub.add_option("--sd-sickness", request.sd_sickness,
                 "Task 1: SD of a person's difference in cybersickness, points")
      ->capture_default_str()
      ->check(number_in(0.01, 10));
  auto* share = sub.add_option("--person-by-method", command.person_by_method,
                               "Task 1: share of an answer's variance, apart from the person's level, that "
                               "belongs to person and method and is the same at every n_*; without: 0")
                    ->check(number_in(0, 1));
  sub.add_option(
         "--earlier", command.earlier,
         "Task 1: take --person-by-method from the results of an earlier study, the JSON of vip-stats "
         "report")
      ->excludes(share);
  sub.add_option("--answers", command.answers, "Task 1: likert (whole scores) or continuous")
      ->capture_default_str()
      ->check(CLI::IsMember({"likert", "continuous"}));
  sub.add_option("--interval-bias", request.interval_bias, "Task 2: log odds for the second interval")
      ->check(number_in(-5, 5));
  sub.add_option("--world", request.worlds,
                 "effect, null, margin or paper; may be repeated. Without: all that apply; margin not with "
                 "hypotheses of one's own")
      ->check(CLI::IsMember({"effect", "null", "margin", "paper"}));
  sub.add_option(
      "--observer", command.observer,
      fmt::format(
          "Pilot: who rates, such as ptpe:a=24,b=0.02,noise=1; without: ptpe:a={:g},b={:g}, as in the paper",
          request.observer.a, request.observer.b));
  sub.add_option("--question", command.choice.question,
                 "Pilot: id of a question; without: the first that the trials ask on a scale");
  add_level_choice(sub, command.choice);
  sub.add_option("--precision-a", request.precision_a,
                 "Pilot: half width that a's interval is to reach, frames/s")
      ->check(number_in(1e-6, 1000));
  sub.add_option("--precision-b", request.precision_b,
                 "Pilot: half width that b's interval is to reach, s/frame")
      ->check(number_in(1e-9, 10));
  sub.add_option("--power", request.power, "Power to be reached")
      ->capture_default_str()
      ->check(number_in(0.01, 0.9999));
  sub.add_option(
         "--studies", command.studies,
         "Simulated for each n; without: 2000, pilots 400; half of it beyond 12 numbers of participants")
      ->check(CLI::Range(2, 1000000));
  sub.add_option("--seed", request.seed, "Seed")->capture_default_str();
  sub.add_option("--plan", command.plan,
                 "Analysis plan (TOML): decision rule, tests, margins, level; without: the defaults");
  sub.add_option("--json", command.json, "File for every number (docs/statistics.md)")->check(output_file());
  sub.add_option("--csv", command.csv, "File for the same numbers as a table")->check(output_file());
  sub.add_option("--svg", command.svg, "File for the curves")->check(output_file());
}

}  // namespace

void add_power_command(CLI::App& app) {
  auto command = std::make_shared<PowerCommand>();
  auto* sub = app.add_subcommand("power", "What n participants can tell: simulation on the protocol's plan");
  add_request_options(*sub, *command);
  auto* out = sub->add_option("--out", command->out, "File of --cell, a shard")->check(output_file());
  add_cells(*sub, command->cells, out, {"--json", "--csv", "--svg"});
  out->needs("--cell");
  auto* merge_command =
      add_merge(*sub, command->cells, [&](CLI::App& merge) { add_request_options(merge, *command); });
  merge_command->callback([command, merge_command] { merge(*command, *merge_command); });
  sub->callback([command, sub, merge_command] {
    if (!merge_command->parsed()) run_power(*command, *sub);
  });
}

}  // namespace apps
