/// vip-stats power: what a study of n participants can tell, by simulation on its protocol's own plan.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "apps/stats/commands.hpp"
#include "apps/stats/power/power_figure.hpp"
#include "apps/stats/power/power_json.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

struct PowerCommand {
  std::string protocol, n, plan, observer, answers = "likert";
  std::string json, csv, svg;
  PowerRequest request;
  int studies = 0;
};

/// Most numbers of participants printed; the files hold all.
constexpr std::size_t printed_columns = 6;

std::vector<std::size_t> columns_to_print(const Json& json) {
  const std::size_t count = json.at("settings").at("n").size();
  std::vector<std::size_t> out;
  const std::size_t columns = std::min(count, printed_columns);
  for (std::size_t i = 0; i < columns; ++i) out.push_back(columns == 1 ? 0 : i * (count - 1) / (columns - 1));
  return out;
}

std::string cell(const Json& point, const std::string& figure, int decimals = 3) {
  if (!point.contains(figure) || !point.at(figure).is_number()) return "-";
  return fmt::format("{0:.{2}f} ({1:.{2}f})", point.at(figure).get<double>(),
                     point.at(figure + "_se").get<double>(), decimals);
}

void print_row(const std::string& name, const Json& curve, const std::string& figure,
               const std::vector<std::size_t>& columns, int decimals = 3) {
  std::printf("  %-34s", name.c_str());
  for (const std::size_t i : columns) std::printf(" %13s", cell(curve[i], figure, decimals).c_str());
  std::printf("\n");
}

void print_head(const Json& json, const std::vector<std::size_t>& columns) {
  std::printf("  %-34s", "participants");
  for (const std::size_t i : columns) std::printf(" %13d", json.at("settings").at("n").at(i).get<int>());
  std::printf("\n");
}

void print_hypothesis(const Json& hypothesis, const Json& settings, const std::vector<std::size_t>& columns) {
  const std::string id = hypothesis.at("id").get<std::string>();
  const auto tests = hypothesis.at("tests").size(), claims = hypothesis.at("claims_true").get<std::size_t>();
  const Json& curve = hypothesis.at("curve");
  const char* const verdict = claims == tests ? " supported (true: power)"
                              : claims > 0    ? " supported (only partly true)"
                                              : " supported (false: error)";
  print_row(id + verdict, curve, "supported", columns);
  if (tests > 1) print_row("  at least one test holds", curve, "any", columns);
  if (claims < tests) print_row("  at least one false claim holds", curve, "any_false", columns);
  print_row("  by the paper's rule", curve, "paper_rule", columns);
  if (!hypothesis.at("n_for_power").is_null())
    std::printf("    power %g from n = %d\n", settings.at("power").get<double>(),
                hypothesis.at("n_for_power").get<int>());
}

/// Single tests, corrected and not, where one number of participants was asked for.
void print_tests(const Json& hypothesis) {
  for (const auto& test : hypothesis.at("tests")) {
    const Json& at = test.at("curve").at(0);
    const Json& closed = at.at("closed_form");
    std::printf("    %-36s truth %6.3g  holds %s  uncorrected %s  formula %s\n",
                test.at("label").get<std::string>().c_str(), test.at("truth").get<double>(),
                cell(at, "holds").c_str(), cell(at, "uncorrected").c_str(),
                closed.is_number() ? fmt::format("{:.3f}", closed.get<double>()).c_str() : "-");
  }
}

void print_worlds(const Json& json) {
  const auto columns = columns_to_print(json);
  for (const auto& world : json.at("worlds")) {
    std::printf("\nWorld \"%s\": %s\n", world.at("id").get<std::string>().c_str(),
                world.at("words").get<std::string>().c_str());
    print_head(json, columns);
    for (const auto& hypothesis : world.at("hypotheses")) {
      print_hypothesis(hypothesis, json.at("settings"), columns);
      if (columns.size() == 1) print_tests(hypothesis);
    }
  }
}

void print_n(const char* name, const Json& n) {
  if (n.is_null())
    std::printf("  %s: not reached\n", name);
  else
    std::printf("  %s: n = %d\n", name, n.get<int>());
}

void print_coefficient(const Json& json, const std::string& name, const char* unit,
                       const std::vector<std::size_t>& columns) {
  Json curve = Json::array();
  for (const auto& point : json.at("precision").at("curve")) curve.push_back(point.at(name));
  const int decimals = name == "a" ? 2 : 4;
  std::printf("%s, %s\n", name.c_str(), unit);
  print_row("mean", curve, "mean", columns, decimals);
  print_row("standard error (of estimates)", curve, "sd", columns, decimals);
  print_row("interval's half width, median", curve, "half_width", columns, decimals);
  print_row("coverage of the interval", curve, "coverage", columns);
  print_row("precision reached", curve, "reached", columns);
}

void print_precision(const Json& json) {
  const auto columns = columns_to_print(json);
  std::printf("\n");
  print_head(json, columns);
  print_row("pilots with an interval", json.at("precision").at("curve"), "interval", columns);
  print_coefficient(json, "a", "frames/s", columns);
  print_coefficient(json, "b", "s/frame", columns);
  const Json &precision = json.at("precision"), &settings = json.at("settings");
  const bool a = settings.at("precision_a").is_number(), b = settings.at("precision_b").is_number();
  if (a || b)
    std::printf("precision wished, reached in a share of %g of pilots:\n",
                settings.at("power").get<double>());
  if (a) print_n("a", precision.at("n_for_a"));
  if (b) print_n("b", precision.at("n_for_b"));
  if (a && b) print_n("both", precision.at("n_for_both"));
}

void refuse(const std::string& option, const std::string& problem, const std::string& mend) {
  throw base::Error(option, problem, mend);
}

/// Options that another kind of protocol asks for would be left without effect.
void check_kind(const PowerRequest& request, PowerKind kind, const CLI::App& options) {
  const auto only = [&](const char* option, bool fits, const char* where) {
    if (options.count(option) > 0 && !fits)
      refuse(option, "means nothing for protocol " + request.protocol.name,
             std::string("it is for ") + where);
  };
  const bool task1 = kind == PowerKind::Task1, task2 = kind == PowerKind::Task2,
             pilot = kind == PowerKind::Pilot;
  for (const char* option : {"--difference", "--sd", "--sd-sickness", "--answers"})
    only(option, task1, "Task 1");
  only("--interval-bias", task2, "Task 2");
  for (const char* option : {"--effect", "--world"}) only(option, !pilot, "Task 1 and Task 2");
  for (const char* option : {"--precision-a", "--precision-b", "--observer"})
    only(option, pilot, "the pilot");
  if (task2 && request.effect && !(*request.effect > 0 && *request.effect < 1))
    refuse("--effect", "is a preference in Task 2, above 0 and below 1", "write --effect 0.7");
}

void complete(PowerCommand& command, const CLI::App& options) {
  PowerRequest& request = command.request;
  if (!command.plan.empty()) request.plan = read_plan(command.plan);
  request.protocol = study::read_protocol(base::find_input(command.protocol));
  request.file = command.protocol;
  const PowerKind kind = power_kind(request.protocol);
  check_kind(request, kind, options);
  request.n = command.n.empty() ? std::vector{request.protocol.participants} : parse_participants(command.n);
  // Half a minute or so on two cores, however many numbers of participants there are.
  const bool many = request.n.size() > 12;
  const int usual_studies = many ? 1000 : 2000, usual_pilots = many ? 200 : 400;
  request.studies = command.studies > 0        ? command.studies
                    : kind == PowerKind::Pilot ? usual_pilots
                                               : usual_studies;
  request.answers = command.answers == "likert" ? AnswerScale::Likert : AnswerScale::Continuous;
  if (!command.observer.empty()) request.observer = study::parse_ptpe_observer(command.observer);
  if (kind == PowerKind::Pilot) return;
  if (request.worlds.empty()) {
    request.worlds = {"null", "margin", "paper"};
    if (request.effect || request.difference) request.worlds.insert(request.worlds.begin(), "effect");
    if (kind == PowerKind::Task2) std::erase(request.worlds, "margin");  // the same as null
    return;
  }
  std::vector<std::string> unique;
  for (const auto& one : request.worlds) {
    if (std::find(unique.begin(), unique.end(), one) == unique.end()) unique.push_back(one);
  }
  // An effect that was given is wanted.
  if ((request.effect || request.difference) &&
      std::find(unique.begin(), unique.end(), "effect") == unique.end())
    unique.insert(unique.begin(), "effect");
  request.worlds = unique;
}

/// All files or none: every one is made before the first is written.
void write_files(const PowerCommand& command, const Json& json) {
  const std::string text = command.json.empty() ? "" : json.dump(2) + "\n";
  const std::string table = command.csv.empty() ? "" : power_csv(json);
  const std::string picture = command.svg.empty() ? "" : power_svg(json);
  if (!text.empty()) base::write_file_atomically(command.json, text);
  if (!table.empty()) base::write_file_atomically(command.csv, table);
  if (!picture.empty()) base::write_file_atomically(command.svg, picture);
}

void run(PowerCommand& command, const CLI::App& options) {
  complete(command, options);
  const PowerRequest& request = command.request;
  const bool pilot = power_kind(request.protocol) == PowerKind::Pilot;
  const Json json = pilot ? power_json(request, simulate_pilot_power(request))
                          : power_json(request, simulate_task_power(request));
  write_files(command, json);
  std::printf(
      "%s %s (SHA-256 %s), %d simulated studies for each n, seed %llu; in brackets: Monte-Carlo "
      "standard error\n",
      request.protocol.name.c_str(), request.protocol.version.c_str(),
      request.protocol.sha256.substr(0, 12).c_str(), request.studies,
      static_cast<unsigned long long>(request.seed));
  pilot ? print_precision(json) : print_worlds(json);
}

}  // namespace

void add_power_command(CLI::App& app) {
  auto command = std::make_shared<PowerCommand>();
  PowerRequest& request = command->request;
  auto* sub = app.add_subcommand("power", "What n participants can tell: simulation on the protocol's plan");
  sub->add_option("protocol", command->protocol, "Protocol file")->required();
  sub->add_option("--n", command->n,
                  "Participants: LOW:HIGH, LOW:HIGH:STEP or one number; without: the protocol's");
  sub->add_option(
         "--effect", request.effect,
         "Task 2: true preference of the better method; Task 1: true difference in standard deviations "
         "of the differences")
      ->check(number_in(-10, 10));
  auto* difference = sub->add_option("--difference", request.difference,
                                     "Task 1: the same in points of realism; cybersickness in proportion")
                         ->check(number_in(-6, 6));
  difference->excludes("--effect");
  sub->add_option("--sd", request.sd_realism, "Task 1: SD of a person's difference in realism, points")
      ->capture_default_str()
      ->check(number_in(0.01, 10));
  sub->add_option("--sd-sickness", request.sd_sickness,
                  "Task 1: SD of a person's difference in cybersickness, points")
      ->capture_default_str()
      ->check(number_in(0.01, 10));
  sub->add_option("--answers", command->answers, "Task 1: likert (whole scores) or continuous")
      ->capture_default_str()
      ->check(CLI::IsMember({"likert", "continuous"}));
  sub->add_option("--interval-bias", request.interval_bias, "Task 2: log odds for the second interval")
      ->check(number_in(-5, 5));
  sub->add_option("--world", request.worlds,
                  "effect, null, margin or paper; may be repeated. Without: all that apply")
      ->check(CLI::IsMember({"effect", "null", "margin", "paper"}));
  sub->add_option("--observer", command->observer, "Pilot: who rates, such as ptpe:a=24,b=0.02,noise=1");
  sub->add_option("--precision-a", request.precision_a, "Pilot: wished half width of a's interval, frames/s")
      ->check(number_in(1e-6, 1000));
  sub->add_option("--precision-b", request.precision_b, "Pilot: wished half width of b's interval, s/frame")
      ->check(number_in(1e-9, 10));
  sub->add_option("--power", request.power, "Power wished")
      ->capture_default_str()
      ->check(number_in(0.01, 0.9999));
  sub->add_option(
         "--studies", command->studies,
         "Simulated for each n; without: 2000, pilots 400; half of it beyond 12 numbers of participants")
      ->check(CLI::Range(2, 1000000));
  sub->add_option("--seed", request.seed, "Seed")->capture_default_str();
  sub->add_option("--plan", command->plan,
                  "Analysis plan (TOML): decision rule, tests, margins, level; without: the defaults");
  sub->add_option("--json", command->json, "File for every number (docs/statistics.md)")
      ->check(output_file());
  sub->add_option("--csv", command->csv, "File for the same numbers as a table")->check(output_file());
  sub->add_option("--svg", command->svg, "File for the curves")->check(output_file());
  sub->callback([command, sub] { run(*command, *sub); });
}

}  // namespace apps
