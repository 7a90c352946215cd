/// vip-stats scale: pairwise choices and ratings on one scale, in just-objectionable differences.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/tasks/scale_json.hpp"
#include "libstudy/store/export_register.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

/// A person with a score from here on is named: the customary limit.
constexpr double suspicious_score = 1.5;

struct ScaleCommand {
  std::string input, ratings, json, plan, by, reference;
  std::vector<std::string> protocols, questions;
  std::string prior = "none";
  bool order_bias = false, incomplete = false;
  int next = 0;
};

stats::ScalePrior prior_of(const std::string& name) {
  for (const auto prior : {stats::ScalePrior::None, stats::ScalePrior::Normal})
    if (name == study::prior_name(prior)) return prior;
  return stats::ScalePrior::Bounded;
}

/// True if the file is a database of SQLite.
bool is_database(const std::string& path) {
  constexpr std::string_view magic("SQLite format 3\0", 16);
  std::string head(magic.size(), '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head == magic;
}

/// base::Error if an option is given that the kind of input does not take.
void check_scale_options(const ScaleCommand& command, bool database) {
  const auto refuse = [](const char* option, const char* kind) {
    throw base::Error(option, std::string("does not apply to ") + kind, "leave it out");
  };
  if (database && !command.ratings.empty()) refuse("--ratings", "a database, which holds its own ratings");
  if (database) return;
  if (!command.plan.empty()) refuse("--plan", "a CSV file");
  if (!command.protocols.empty()) refuse("--protocol", "a CSV file");
  if (!command.questions.empty()) refuse("--question", "a CSV file");
  if (command.incomplete) refuse("--incomplete", "a CSV file");
}

/// base::Error if the JSON file would overwrite an input, or both inputs are one file.
void check_files(const ScaleCommand& command, bool database) {
  if (database) return check_apart(command.input, {{"--json", command.json}});
  const auto same = [](const std::string& a, const std::string& b) {
    return !a.empty() && !b.empty() &&
           std::filesystem::weakly_canonical(a) == std::filesystem::weakly_canonical(b);
  };
  if (same(command.ratings, command.input))
    throw base::Error("--ratings " + command.ratings, "is the file of choices",
                      "give a CSV file with the columns condition and score, or leave it out");
  for (const auto& [input, what] :
       {std::pair(command.input, "choices"), std::pair(command.ratings, "ratings")})
    if (same(command.json, input))
      throw base::Error("--json " + command.json, std::string("is the file of ") + what,
                        "give the output a path of its own");
}

std::string text_of(const study::Json& value) { return value.get<std::string>(); }

std::string decimals(const study::Json& value, int digits) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), digits) : "-";
}

std::string interval_of(const study::Json& ci) {
  if (!ci.is_array()) return "-";
  const int digits = study::interval_decimals({study::number_of(ci[0]), study::number_of(ci[1])}, 2);
  return "[" + decimals(ci[0], digits) + ", " + decimals(ci[1], digits) + "]";
}

/// One line of the printed scale.
struct ScaleLine {
  std::string condition;
  double jod = 0;
  std::string interval;
};

/// The conditions, best first, about their mean or less the reference.
std::vector<ScaleLine> lines_of(const study::Json& scale, const std::string& reference) {
  std::vector<ScaleLine> out;
  if (reference.empty()) {
    for (const auto& one : scale.at("conditions"))
      out.push_back({text_of(one.at("condition")), one.at("jod").get<double>(), interval_of(one.at("ci"))});
  } else {
    out.push_back({reference, 0, "reference"});
    for (const auto& one : scale.at("differences")) {
      const bool first = text_of(one.at("a")) == reference, second = text_of(one.at("b")) == reference;
      if (!first && !second) continue;
      study::Json ci = one.at("ci");
      if (first && ci.is_array())
        ci = study::Json::array({-study::number_of(ci[1]), -study::number_of(ci[0])});
      out.push_back({text_of(one.at(first ? "b" : "a")), (first ? -1 : 1) * one.at("jod").get<double>(),
                     interval_of(ci)});
    }
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const ScaleLine& a, const ScaleLine& b) { return a.jod > b.jod; });
  return out;
}

/// Each pair once, in the order in which it is first proposed, with the number of answers to ask.
void print_next(const study::Json& next) {
  struct Asked {
    std::string pair;
    int answers = 0;
    double bits = 0;
  };
  std::vector<Asked> list;
  for (const auto& one : next) {
    const std::string pair = text_of(one.at("a")) + ", " + text_of(one.at("b"));
    auto found =
        std::find_if(list.begin(), list.end(), [&](const Asked& asked) { return asked.pair == pair; });
    if (found == list.end()) found = list.insert(list.end(), Asked{pair});
    ++found->answers;
    found->bits += one.at("bits").get<double>();
  }
  std::printf("pairs to ask next, with the gain of these answers:\n");
  for (const Asked& one : list)
    std::printf("  %s: %d %s, %.4f bits\n", one.pair.c_str(), one.answers,
                one.answers == 1 ? "answer" : "answers", one.bits);
}

void print_scale(const study::Json& json, const study::Json& scale, const std::string& reference) {
  const std::string name = text_of(scale.at("name"));
  if (!name.empty()) std::printf("\n%s %s\n", text_of(json.at("by")).c_str(), name.c_str());
  const auto ratings = scale.at("ratings").get<double>();
  const study::Json& people = scale.at("people");
  std::printf("%zu conditions, %.0f choices%s, %s\n", scale.at("conditions").size(),
              scale.at("choices").get<double>(),
              ratings > 0 ? fmt::format(", {:.0f} ratings", ratings).c_str() : "",
              !people.is_number()      ? "people not known"
              : people.get<int>() == 1 ? "1 person"
                                       : fmt::format("{} people", people.get<int>()).c_str());
  const auto lines = lines_of(scale, reference);
  std::size_t width = 9;
  for (const ScaleLine& line : lines) width = std::max(width, line.condition.size());
  const auto wide = static_cast<int>(width);
  const std::string why = text_of(scale.at("why_no_intervals"));
  std::printf(
      "%-*s %7s  %s\n", wide, "condition", "JOD",
      why.empty() ? fmt::format("{:g} % interval", 100 * json.at("confidence").get<double>()).c_str() : "");
  for (const ScaleLine& line : lines)
    std::printf("%-*s %7.2f  %s\n", wide, line.condition.c_str(), line.jod,
                why.empty() ? line.interval.c_str() : "");
  if (!why.empty()) std::printf("no intervals: %s\n", why.c_str());
  if (const study::Json& order = scale.at("order_bias"); order.is_object())
    std::printf("bias towards the condition shown first: %s JOD, standard error %s\n",
                decimals(order.at("jod"), 2).c_str(), decimals(order.at("se"), 2).c_str());
  if (const study::Json& rating = scale.at("rating"); rating.is_object())
    std::printf(
        "ratings rise by %s of their standard deviation a JOD, standard error %s%s\n",
        decimals(rating.at("slope"), 2).c_str(), decimals(rating.at("se"), 2).c_str(),
        rating.at("slope").get<double>() < 0 ? "; below 0, ratings and choices contradict each other" : "");
  if (scale.at("next").empty()) return;
  print_next(scale.at("next"));
}

void print_observers(const study::Json& json) {
  const study::Json& observers = json.at("observers");
  if (json.at("people_known").get<bool>() && observers.empty())
    std::printf("\nno analysis of single people: %s\n", text_of(json.at("why_no_observers")).c_str());
  if (observers.empty()) return;
  int named = 0;
  for (const auto& one : observers) {
    const double score = one.at("score").get<double>(), each = one.at("score_per_answer").get<double>();
    if (std::max(score, each) < suspicious_score) continue;
    if (named++ == 0)
      std::printf(
          "\npeople whose answers fit the others' scale worst (look at their data before a decision):\n");
    std::printf("  %s: %.0f answers, log-likelihood %.1f, score %.2f, by answer %.2f\n",
                text_of(one.at("person")).c_str(), one.at("answers").get<double>(),
                one.at("log_likelihood").get<double>(), score, each);
  }
  if (named == 0)
    std::printf("\nno person's answers stand out against the others' scale (all scores below %g)\n",
                suspicious_score);
}

void check_reference(const study::Json& json, const std::string& reference) {
  if (reference.empty()) return;
  for (const auto& scale : json.at("scales")) {
    std::vector<std::string> names;
    for (const auto& one : scale.at("conditions")) names.push_back(text_of(one.at("condition")));
    if (std::find(names.begin(), names.end(), reference) == names.end())
      throw base::Error(
          "--reference " + base::shortened(reference),
          "is no condition" +
              (text_of(scale.at("name")).empty() ? std::string() : " of " + text_of(scale.at("name"))),
          base::use_one_of(reference, names));
  }
}

void run_scale(const ScaleCommand& command) {
  const bool database = is_database(command.input);
  check_scale_options(command, database);
  check_files(command, database);
  // The database registers files with people's data, because a withdrawal must delete them. The register is
  // opened before the data are read, and only if a file is to be written.
  std::optional<study::RegisteredFiles> files;
  if (database && !command.json.empty()) files.emplace(study::StudyFile(command.input, command.incomplete));
  study::ScaleRequest request{.place = command.input,
                              .source = std::filesystem::path(command.input).filename().string(),
                              .options = {.prior = prior_of(command.prior), .order_bias = command.order_bias},
                              .next = command.next};
  study::ScaleTable table;
  if (database) {
    study::PlanInForce plan;
    if (!command.plan.empty()) plan = study::read_plan(command.plan);
    request.options.confidence = plan.plan.confidence;
    table =
        study::scale_table_of_study(study::read_tasks(study::StudyFile(command.input, command.incomplete)),
                                    {.database = command.input,
                                     .protocols = command.protocols,
                                     .questions = command.questions,
                                     .by = command.by,
                                     .exclusions = plan.plan.exclusions});
  } else {
    table = study::scale_table_of_csv(command.input, command.ratings, command.by);
  }
  const study::Json json = study::scale_json(table, request);
  check_reference(json, command.reference);
  if (files) files->write("vip-stats scale", command.json, json.dump(2) + "\n");
  if (!files && !command.json.empty()) base::write_file_atomically(command.json, json.dump(2) + "\n");
  for (const char* kind : {"warnings", "notes"})
    for (const auto& one : json.at(kind))
      std::printf("%s: %s\n", std::string_view(kind) == "warnings" ? "WARNING" : "note",
                  text_of(one).c_str());
  std::printf("a condition 1 JOD above another is chosen in 75 %% of answers; prior: %s; %s\n",
              command.prior.c_str(),
              command.reference.empty() ? "the values sum to 0"
                                        : ("values less that of " + command.reference).c_str());
  for (const auto& scale : json.at("scales")) print_scale(json, scale, command.reference);
  print_observers(json);
}

}  // namespace

void add_scale_command(CLI::App& app) {
  auto command = std::make_shared<ScaleCommand>();
  auto* sub = app.add_subcommand(
      "scale", "Pairwise choices and ratings on one scale, in just-objectionable differences (JOD)");
  auto* input =
      sub->add_option("database", command->input,
                      "Database of vip-study, or CSV file of choices with the columns first, second, "
                      "chosen, and person (docs/statistics.md)");
  sub->add_option("--db", command->input, "The same as an option")->excludes(input);
  sub->add_option(
      "--ratings", command->ratings,
      "CSV file of ratings beside the CSV file of choices, with the columns condition, score, and "
      "person");
  sub->add_option(
      "--by", command->by,
      "Column, or scene, method, n_*, frame rate or factor of a database: each of its values gets "
      "a scale of its own");
  sub->add_option("--prior", command->prior,
                  "none: maximum likelihood; normal: a weak one, by which conditions spread with a standard "
                  "deviation of 5 JOD; bounded: that of pwcmp")
      ->check(CLI::IsMember({"none", "normal", "bounded"}))
      ->capture_default_str();
  sub->add_flag("--order-bias", command->order_bias,
                "Also estimates the bias towards the condition shown first");
  sub->add_option("--reference", command->reference,
                  "Condition that gets the value 0; without: the sum is 0");
  add_count(*sub, "--next", command->next, 0, 1000, "Number of pairs to propose, those that tell most first");
  sub->add_option("--json", command->json, "File for every number (docs/report.md)")->check(output_file());
  add_plan(*sub, command->plan);
  sub->add_option(
         "--protocol", command->protocols,
         "Name of a protocol, 'NAME VERSION', or first digits of its SHA-256; may be given twice: of "
         "choices and of ratings")
      ->allow_extra_args(false);
  sub->add_option("--question", command->questions,
                  "Id of a question; may be given twice: of choices and of ratings")
      ->allow_extra_args(false);
  add_incomplete(*sub, command->incomplete);
  sub->footer(std::string("Files made from a database:\n") + registered_files);
  sub->callback([command] {
    check_given(command->input);
    run_scale(*command);
  });
}

}  // namespace apps
