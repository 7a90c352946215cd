/// vip-stats fit-people: each participant's own threshold curve mu = a exp(b delta), with partial pooling
/// over the participants of a PTPE pilot.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/stats/choice_options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/ptpe/people_contours.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct PeopleCommand {
  std::string database, json, plan, person, out;
  std::optional<std::string> exclude;
  bool incomplete = false;
  ChoiceOptions choice;

  study::StudyFile file() const { return {database, incomplete}; }
};

[[noreturn]] void no_contours(const PeopleCommand& command, const std::string& reason,
                              const std::string& mend) {
  throw base::Error(command.database, "no curves of single people: " + reason,
                    mend + "; nothing was written");
}

std::string ends(const std::array<double, 2>& ci, int decimals) {
  const int shown = study::interval_decimals(ci, decimals);
  return fmt::format("[{:.{}f}, {:.{}f}]", ci[0], shown, ci[1], shown);
}

std::string rate_ends(const std::array<double, 2>& ci) {
  if (ci[1] > study::highest_rate) return fmt::format("[{:.1f}, no upper bound]", ci[0]);
  return fmt::format("[{:.1f}, {:.1f}]", ci[0], ci[1]);
}

void print_population(const study::PeopleContours& contours) {
  const auto& fit = contours.fit;
  const auto& data = contours.data;
  std::printf("%s %s, question \"%s\", level %.3g: %zu people, %d ratings of %d settings\n",
              data.protocol.name.c_str(), data.protocol.version.c_str(), data.question.id.c_str(), fit.level,
              fit.people.size(), fit.n, fit.settings);
  if (data.test_data) std::printf("note: these are test data, not a study\n");
  if (!data.simulated.empty()) std::printf("note: %zu participants are simulated\n", data.simulated.size());
  if (!data.imported.empty()) std::printf("note: imported: %s\n", data.imported_words().c_str());
  int excluded = 0;
  for (const auto& one : data.exclusions) excluded += one.answers;
  if (excluded > 0) std::printf("note: %d answers are left out by rule or by hand\n", excluded);
  const auto& population = fit.population;
  std::printf("mu = a exp(b delta) with %.0f %% intervals\n", 100 * contours.confidence);
  std::printf("  population: a = %.2f %s frames/s, b = %.4f %s s/frame\n", population.curve.a(),
              rate_ends(population.a_ci).c_str(), population.curve.b, ends(population.b_ci, 4).c_str());
  if (contours.out_of_reach())
    std::printf(
        "  note: this curve lies outside the frame rates shown at more than half of the deltas: another "
        "--level is needed\n");
  std::printf("  SD between people: log a %.3f %s, b %.4f %s; correlation %.2f %s\n", fit.sd_log_a.value,
              ends(fit.sd_log_a.ci, 3).c_str(), fit.sd_b.value, ends(fit.sd_b.ci, 4).c_str(),
              fit.correlation.value, ends(fit.correlation.ci, 2).c_str());
  std::printf(
      "  lapses: %.1f %% of answers; drift over a session: %s\n", 100 * fit.lapse,
      fit.drift
          ? fmt::format("{:.2f} {} SDs of a single answer", fit.drift->value, ends(fit.drift->ci, 2)).c_str()
          : "not estimated, as a trial's position is not known");
}

void print_people(const study::PeopleContours& contours) {
  std::size_t width = 6;
  for (const auto& one : contours.fit.people) width = std::max(width, contours.code(one).size());
  const int wide = static_cast<int>(width);
  std::printf("\n%-*s %8s %7s %-15s %8s %-18s %16s %5s\n", wide, "person", "answers", "a", "interval", "b",
              "interval", "alone: a, b", "own");
  int doubts = 0;
  for (const auto& one : contours.fit.people) {
    const auto& curve = one.pooled.curve;
    std::printf(
        "%-*s %8d %7.2f %-15s %8.4f %-18s %16s %5.2f%s\n", wide, contours.code(one).c_str(), one.answers,
        curve.a(), rate_ends(one.a_ci).c_str(), curve.b, ends(one.b_ci, 4).c_str(),
        one.alone ? fmt::format("{:.2f}, {:.4f}", one.alone->curve.a(), one.alone->curve.b).c_str() : "-",
        one.own_share, contours.doubt(one).empty() ? "" : " *");
    doubts += !contours.doubt(one).empty();
  }
  std::printf(
      "alone: by the person's answers without those of others. own: share of the person's own answers in "
      "the\n"
      "curve, 0 (all from others) to 1.\n");
  if (doubts > 0)
    std::printf("* no contour of the person's own%s:\n",
                contours.out_of_reach() ? "" : "; take the population's");
  for (const auto& one : contours.fit.people)
    if (const auto doubt = contours.doubt(one); !doubt.empty())
      std::printf("  %s: %s\n", contours.code(one).c_str(), doubt.c_str());
}

/// The participant of --person, whose contour may be used.
const stats::PersonContour& chosen_person(const PeopleCommand& command,
                                          const study::PeopleContours& contours) {
  const auto* found = contours.find(command.person);
  if (!found) {
    std::vector<std::string> codes;
    for (const auto& one : contours.fit.people) codes.push_back(contours.code(one));
    throw base::Error("--person " + base::shortened(command.person), "has no answer in this fit",
                      base::use_one_of(command.person, codes));
  }
  if (const auto doubt = contours.doubt(*found); !doubt.empty())
    throw base::Error("--person " + base::shortened(command.person),
                      "has no contour of the person's own: " + doubt,
                      contours.out_of_reach()
                          ? "choose another --level: the population's curve lies outside the frame rates "
                            "shown too; nothing was written"
                          : "give the solver the population's curve, by vip-stats fit-ptpe with --out; "
                            "nothing was written");
  return *found;
}

void fit_people(const PeopleCommand& command) {
  check_apart(command.database, {{"--json", command.json}, {"--out", command.out}, {"--plan", command.plan}});
  if (!command.out.empty() && command.person.empty())
    throw base::Error("--person", "is empty", "give the code of a participant");
  stats::AnalysisPlan plan;
  if (!command.plan.empty()) plan = study::read_plan(command.plan).plan;
  if (command.exclude) plan.exclusions.timing = study::timing_rule_of(*command.exclude);
  // The register is opened before the data are read, and only if a file is to be written.
  std::optional<study::RegisteredFiles> files;
  if (!command.json.empty() || !command.out.empty()) files.emplace(command.file());
  const auto study = study::read_tasks(command.file());
  if (!study.lacking.empty()) std::printf("incomplete: %s\n", study.lacking.c_str());
  const auto selection = command.choice.selection(study::TaskKind::Pilot, plan);
  const auto chosen = study::choose_task(study, selection);
  if (!chosen) no_contours(command, chosen.reason(), study::mend_of_choice(study, selection));
  auto data = study::collect_task(study, *chosen, plan.exclusions);
  const double level = study::level_of(selection, chosen->question);
  if (const auto nothing = study::nothing_counts(data); !nothing.empty())
    no_contours(command, nothing,
                data.flow.trials_excluded > 0 ? "collect answers, or choose another --exclude or --plan"
                                              : "collect answers");
  if (!study::within_scale(level, chosen->question))
    no_contours(command, study::outside_scale(level, chosen->question),
                study::mend_of_level(chosen->question));
  const auto contours = study::fit_people_contours(std::move(data), level, plan.confidence, plan.pilot);
  if (!contours)
    no_contours(command, contours.reason(),
                "collect more answers or participants, choose another --level, or fit one curve for all with "
                "vip-stats fit-ptpe");
  const auto* person = command.person.empty() ? nullptr : &chosen_person(command, *contours);
  if (!command.json.empty()) {
    auto json = study::people_contours_json(*contours);
    if (!study.lacking.empty()) json["incomplete"] = study.lacking;
    files->write("vip-stats fit-people", command.json, json.dump(2) + "\n");
  }
  if (person)
    files->write("vip-stats fit-people", command.out,
                 sim::format_ptpe_file(study::person_ptpe_file(*contours, *person)));
  print_population(*contours);
  print_people(*contours);
}

}  // namespace

void add_fit_people_command(CLI::App& app) {
  auto command = std::make_shared<PeopleCommand>();
  auto* sub = app.add_subcommand(
      "fit-people", "Each participant's own mu = a exp(b delta) in a PTPE pilot, with partial pooling");
  add_database_argument(*sub, command->database);
  add_incomplete(*sub, command->incomplete);
  add_choice(*sub, command->choice);
  sub->add_option("--json", command->json, "File for every number (docs/statistics.md)")
      ->check(output_file());
  auto* person =
      sub->add_option("--person", command->person, "Code of the participant whose curve --out gets");
  auto* out = sub->add_option("--out", command->out,
                              "File for the solver (TOML) with the curve of --person, as fit-ptpe writes it "
                              "for all")
                  ->check(output_file());
  person->needs(out);
  out->needs(person);
  sub->add_option(
      "--plan", command->plan,
      "Analysis plan (TOML) with the rules of exclusion; without: the defaults, as for the tasks");
  sub->add_option("--exclude", command->exclude,
                  "Trials left out by timing verdict, instead of what the plan says (default: fail)")
      ->check(CLI::IsMember({"none", "fail", "degraded"}));
  sub->footer(registered_files);
  sub->callback([command] {
    check_given(command->database);
    fit_people(*command);
  });
}

}  // namespace apps
