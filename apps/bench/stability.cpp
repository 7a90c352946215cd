/// vip-bench stability: how far the frame step, the iterations and the own quantity (such as a speed) of each
/// hard case, a scene that strains the solver, can change before the case fails.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>

#include "apps/bench/commands.hpp"
#include "apps/common/options.hpp"
#include "libsim/cases/hard_case.hpp"
#include "libsim/measure/stability_map.hpp"
#include "libsim/measure/timed_run.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

using sim::cases::HardCase;
using sim::cases::Outcome;
using sim::cases::Setting;

struct StabilityOptions {
  std::string cases = "all", methods = "all", backend = "auto";
  std::string effects;  ///< scene file whose effects act on the water of all cases; empty: no effects
  std::string csv, markdown, svg;
  double most = 4, resolution = 1.5;
  bool quick = false, full = false;
};

/// One case with one method: a run at the case's usual numbers, and a search for the limit of each knob
/// (frame step, iterations, or the quantity that the case scales).
struct CaseRun {
  const HardCase* hard_case;
  Setting setting;
  std::vector<measure::MapCell> cells = {};
};
constexpr std::size_t steps_of_a_job = 1 + std::size(measure::all_knobs);

std::vector<const HardCase*> cases_of(const std::string& words) {
  std::vector<const HardCase*> out;
  if (words == "all") {
    for (const HardCase& one : sim::cases::hard_cases()) out.push_back(&one);
    return out;
  }
  for (const auto& word : base::split(words)) out.push_back(&sim::cases::hard_case(word));
  if (out.empty())
    throw base::Error("--case", "names no case", "leave it out for all cases, or write for example S9");
  return out;
}

std::vector<sim::MethodKind> methods_of(const std::string& words) {
  std::vector<sim::MethodKind> out;
  if (words == "all") {
    for (const auto& traits : sim::all_methods()) out.push_back(traits.kind);
    return out;
  }
  for (const auto& word : base::split(words)) out.push_back(sim::parse_method(word));
  if (out.empty())
    throw base::Error("--method", "names no method",
                      "leave it out for all methods, or write for example Ours");
  return out;
}

/// The failed findings of a case as text; empty if the case passed.
std::string failure(const Outcome& outcome) {
  if (outcome.passes()) return "";
  Outcome failed{.findings = {}, .stopped = outcome.stopped};
  std::copy_if(outcome.findings.begin(), outcome.findings.end(), std::back_inserter(failed.findings),
               [](const auto& finding) { return !finding.passes(); });
  const std::string text = failed.text();
  return text.starts_with("; ") ? text.substr(2) : text;
}

/// Runs a case. With effects only stability is judged, because effects change the rest positions and the
/// speeds of the water.
Outcome run(const HardCase& hard_case, const Setting& setting) {
  const Outcome outcome = hard_case.run(setting);
  return setting.effects.empty() ? outcome : of_stability(outcome);
}

/// Runs a case and returns its failed findings as text, or an empty text if the case passed. A setting that
/// the program refuses counts as failed.
std::string failure(const HardCase& hard_case, const Setting& setting) {
  try {
    return failure(run(hard_case, setting));
  } catch (const base::Error& error) {
    return std::string("is refused: ") + error.what();
  }
}

void turn(const CaseRun& job, const StabilityOptions& options, measure::MapCell& cell) {
  const HardCase& one = *job.hard_case;
  if (cell.knob == measure::Knob::Iterations) {
    const auto limit = measure::fewest(
        [&](int count) {
          Setting setting = job.setting;
          setting.iterations = count;
          return failure(one, setting);
        },
        one.iterations);
    cell.limit = limit.passed;
    cell.reach = limit.reach;
    cell.failed = limit.failed;
    return;
  }
  const auto limit = measure::largest_factor(
      [&](double factor) {
        Setting setting = job.setting;
        (cell.knob == measure::Knob::FrameStep ? setting.frame_dt_s : setting.scale) = factor * cell.usual;
        return failure(one, setting);
      },
      options.most, options.resolution);
  cell.limit = limit.passed * cell.usual;
  cell.reach = limit.reach;
  cell.failed = limit.failed;
}

/// Fills job.cells; a case that scales no quantity gets no cell for the scale. Calls `step` once after the
/// run at the usual numbers and once for each knob.
void measure(CaseRun& job, const StabilityOptions& options, const std::function<void()>& step) {
  const HardCase& one = *job.hard_case;
  // Errors of this run are not caught: if the back end fails, its error ends the command.
  const std::string at_its_own = failure(run(one, job.setting));
  step();
  for (const measure::Knob knob : measure::all_knobs) {
    if (knob == measure::Knob::Scale && *one.scaled == '\0') {
      step();
      continue;
    }
    measure::MapCell cell{.case_id = one.id,
                          .title = one.title,
                          .method = sim::method_name(job.setting.method),
                          .knob = knob,
                          .of = knob == measure::Knob::FrameStep    ? "s"
                                : knob == measure::Knob::Iterations ? "projections a substep"
                                                                    : std::string("times ") + one.scaled,
                          .failed = at_its_own};
    cell.usual = knob == measure::Knob::FrameStep    ? one.frame_dt_s
                 : knob == measure::Knob::Iterations ? one.iterations
                                                     : 1;
    cell.limit = cell.usual;
    cell.reach = measure::Reach::UsualFails;
    if (at_its_own.empty()) turn(job, options, cell);
    job.cells.push_back(cell);
    step();
  }
}

/// Measures all jobs; on the CPU, several jobs in parallel, each on one thread. Results do not depend on the
/// number of threads.
void measure_all(std::vector<CaseRun>& jobs, const StabilityOptions& options, sim::Backend backend) {
  base::Progress progress("cases", jobs.size() * steps_of_a_job);
  std::size_t done = 0;
  std::exception_ptr broken;
  const auto count = static_cast<std::ptrdiff_t>(jobs.size());
#pragma omp parallel for schedule(dynamic, 1) if (backend == sim::Backend::Cpu && count > 1)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    try {
      measure(jobs[static_cast<std::size_t>(i)], options, [&] {
#pragma omp critical(stability_progress)
        progress.update(++done);
      });
    } catch (...) {
#pragma omp critical(stability_progress)
      if (!broken) broken = std::current_exception();
    }
  }
  if (broken) std::rethrow_exception(broken);
}

std::vector<sim::Effect> effects_of(const std::string& path) {
  if (path.empty()) return {};
  auto effects = sim::read_scene(base::find_input(path)).effects;
  if (effects.empty())
    throw base::Error("--effects " + path, "is a scene without effects",
                      "give one that has [[effect]] tables");
  return effects;
}

/// One text per effect, such as "cohesion tension_n_m = 1000".
std::vector<std::string> in_words(const std::vector<sim::Effect>& effects) {
  std::vector<std::string> out;
  for (const auto& effect : effects) {
    const auto& traits = sim::traits_of(effect.kind);
    out.push_back(std::string(traits.word) + " " + traits.key + " = " +
                  figures::shortest(effect.coefficient) + sim::options_in_words(effect));
  }
  return out;
}

measure::StabilityMap map_of(const StabilityOptions& options) {
  const auto backend = sim::choose_backend(options.backend);
  const auto effects = effects_of(options.effects);
  measure::StabilityMap out;
  out.most = options.most;
  out.resolution = options.resolution;
  out.circumstances = measure::processor() + "; back end " + sim::backend_name(backend) + "; " +
                      (options.full ? "full size" : "small size") + "; seed 1 of temporal acceleration";
  out.effects = in_words(effects);
  const auto methods = methods_of(options.methods);
  for (const auto method : methods) out.methods.push_back(sim::method_name(method));
  std::vector<CaseRun> jobs;
  for (const HardCase* one : cases_of(options.cases)) {
    out.cases.emplace_back(one->id);
    for (const auto method : methods) {
      if (std::count(one->methods.begin(), one->methods.end(), method) == 0) continue;
      jobs.push_back({one,
                      {.method = method,
                       .backend = backend,
                       .size = options.full ? sim::cases::Size::Full : sim::cases::Size::Small,
                       .effects = effects}});
    }
  }
  measure_all(jobs, options, backend);
  for (const CaseRun& job : jobs) out.cells.insert(out.cells.end(), job.cells.begin(), job.cells.end());
  return out;
}

void run_stability(StabilityOptions options) {
  if (options.quick) options.most = options.resolution = 2;
  if (options.resolution > options.most) {
    throw base::Error("--resolution " + figures::shortest(options.resolution),
                      "is larger than every factor that the search tries",
                      "use at most --most, which is " + figures::shortest(options.most));
  }
  check_apart("", {{"--csv", options.csv}, {"--markdown", options.markdown}, {"--svg", options.svg}});
  const measure::StabilityMap map = map_of(options);
  std::printf("%s", measure::to_markdown(map).c_str());
  if (!options.csv.empty()) base::write_file_atomically(options.csv, figures::to_csv(measure::to_table(map)));
  if (!options.markdown.empty()) base::write_file_atomically(options.markdown, measure::to_markdown(map));
  if (!options.svg.empty()) base::write_file_atomically(options.svg, measure::to_svg(map));
}

}  // namespace

void add_stability_command(CLI::App& app) {
  auto options = std::make_shared<StabilityOptions>();
  auto* command = app.add_subcommand("stability",
                                     "How far the hard cases are from failing: largest frame step, fewest "
                                     "iterations, highest speed or size");
  command->add_option("--case", options->cases, "all, or ids with commas, such as S9 (docs/results.md)")
      ->capture_default_str();
  command->add_option("--method", options->methods, "all, or names with commas")->capture_default_str();
  command->add_option("--effects", options->effects, "Scene file whose effects the cases' water has");
  add_backend(*command, options->backend);
  auto* most = command->add_option("--most", options->most, "Largest factor of a frame step or a scale")
                   ->check(number_in(1.01, 64.0))
                   ->capture_default_str();
  auto* resolution = command
                         ->add_option("--resolution", options->resolution,
                                      "Factor between what passed and what failed, at most")
                         ->check(number_in(1.01, 8.0))
                         ->capture_default_str();
  command->add_flag("--quick", options->quick, "Only tell what twice as much does: --most 2 --resolution 2")
      ->excludes(most)
      ->excludes(resolution);
  command->add_flag("--full", options->full, "Cases at full size, for a GPU; without: seconds on one core");
  command->add_option("--csv", options->csv, "File for a row for each case, method and number turned")
      ->check(output_file());
  command->add_option("--markdown", options->markdown, "File for a row for each case and method")
      ->check(output_file());
  command->add_option("--svg", options->svg, "File for the map as a picture")->check(output_file());
  command->callback([options] { run_stability(*options); });
}

}  // namespace apps
