/// vip-bench accuracy: error and milliseconds of solver settings, and the effect of each parameter of the
/// solver.

#include <omp.h>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "apps/bench/commands.hpp"
#include "apps/common/options.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/setting/named_scenes.hpp"
#include "libstudy/sweep/run/accuracy_page.hpp"
#include "libstudy/sweep/run/budget.hpp"
#include "libstudy/sweep/run/machine_lock.hpp"
#include "libstudy/sweep/run/run_cell.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/program.hpp"
#include "stats/base/progress.hpp"

namespace apps {

namespace {

using study::sqlite::Open;

struct AccuracyOptions {
  std::string scene = "SingleDam", n_star = "4k", backend = "auto";
  std::string database, cell, out, csv, prices_csv, markdown, html;
  std::string budget, error = "centre", kept = "240x135";
  std::string of_method, of_n_star;
  double of_rate = 0;
  std::optional<base::PictureSize> size;
  double seconds = 2;
  int seeds = 2, front_seeds = 0;
  bool quick = false, list = false, table_only = false;
  std::vector<std::string> shards;
};

/// Checks the size of the stored pictures and returns it as text, such as "240x135". Returns an empty text
/// for "none".
std::string kept_size(const std::string& words) {
  if (words == "none") return "";
  const auto size = base::parse_picture_size(words, "--pictures");
  if (std::min(size.width, size.height) < 32)
    throw base::Error("--pictures " + words, "is too small to be compared",
                      "use 32 px a side or more, or none");
  return base::size_words(size);
}

/// Rounds to multiples of 1/30 s, the interval of measurements, so that a run at any frame rate ends with a
/// measurement.
double whole_samples(double seconds) { return std::round(30 * seconds) / 30; }

study::SweepPlan plan_of(const AccuracyOptions& options) {
  study::SweepPlan out{.scene = options.scene,
                       .n_star = sim::parse_n_star(options.n_star),
                       .seconds = whole_samples(options.seconds),
                       .seeds = options.seeds,
                       .size = options.size ? base::size_words(*options.size) : "",
                       .kept = kept_size(options.kept),
                       .quick = options.quick};
  if (out.quick) out.n_star = std::min<std::int64_t>(out.n_star, 256);
  if (out.quick) out.seconds = std::min(out.seconds, 0.5);
  if (!out.quick && out.n_star < 256) {
    throw base::Error("--n-star " + options.n_star, "is too small: the sweep also runs a quarter of it",
                      "use 256 or more");
  }
  return out;
}

struct Job {
  sim::CellScene scene;
  study::SweepPlan plan;
  study::SweepOrigin origin;
  sim::Backend backend;
  std::vector<study::SweepCell> cells;
  std::string key(const study::SweepCell& cell) const {
    return study::key_of(cell, origin.scene_sha256, origin.program);
  }
};

/// Describes the processor, the device and the number of threads, which affect the times.
std::string machine(sim::Backend backend) {
  const std::string device = sim::device_name(backend);
  return fmt::format("{}; {}, {} threads", measure::processor(), device.empty() ? "cpu" : device,
                     omp_get_max_threads());
}

Job job_of(const AccuracyOptions& options) {
  if (options.scene == "all")
    throw base::Error("--scene all", "is more than one sweep",
                      "name one scene; one --db file can store several sweeps");
  Job out{
      sim::scenes_of(options.scene).front(), plan_of(options), {}, sim::choose_backend(options.backend), {}};
  out.origin = {machine(out.backend), base::program_words(), out.scene.scene.sha256};
  out.cells = study::cells_of(out.plan);
  return out;
}

study::StoredCell run(const Job& job, const study::SweepCell& cell) {
  const study::MachineLock alone;
  return {cell, job.origin, study::run_cell(cell, job.scene.scene, job.backend)};
}

/// Prints the only guard count that a sweep stores: how often the speed of particles was limited.
void print_braked(const Job& job, std::int64_t braked) {
  sim::print_guards(job.scene.name, {.speed_limited = static_cast<std::uint64_t>(braked)}, {});
}

void print_list(const Job& job) {
  for (const auto& cell : job.cells)
    std::printf("%s %s\n", job.key(cell).c_str(), study::to_text(cell).c_str());
}

void run_one(const Job& job, const AccuracyOptions& options) {
  const auto found = std::find_if(job.cells.begin(), job.cells.end(),
                                  [&](const auto& cell) { return job.key(cell) == options.cell; });
  if (found == job.cells.end()) {
    throw base::Error("--cell " + options.cell, "is no cell of this sweep",
                      "copy one from --list, given with the same program and options");
  }
  study::SweepFile file(options.out, Open::Create);
  if (file.keys(job.origin.machine).contains(options.cell)) return;
  const auto cell = run(job, *found);
  file.add(cell);
  print_braked(job, cell.run.braked);
}

/// Runs the cells (one setting with one start each) that `file` lacks. Stores each finished cell at once, so
/// that an interrupted run can continue.
void run_missing(const Job& job, study::SweepFile& file, const std::vector<study::SweepCell>& cells) {
  const auto done = file.keys(job.origin.machine);
  std::vector<study::SweepCell> missing;
  for (const auto& cell : cells)
    if (!done.contains(job.key(cell))) missing.push_back(cell);
  if (missing.empty()) return;
  base::Progress progress("cells", missing.size());
  std::size_t finished = 0;
  std::int64_t braked = 0;
  for (const auto& cell : missing) {
    const auto ran = run(job, cell);
    file.add(ran);
    braked += ran.run.braked;
    progress.update(++finished);
  }
  print_braked(job, braked);
}

/// Prints how many cells of the sweep this machine has run, if some are missing. Tables and choices do not
/// use cells of other machines.
void tell_missing(const Job& job, study::SweepFile& file) {
  const auto done = file.keys(job.origin.machine);
  const auto there = std::count_if(job.cells.begin(), job.cells.end(),
                                   [&](const auto& cell) { return done.contains(job.key(cell)); });
  if (static_cast<std::size_t>(there) < job.cells.size())
    std::printf("%td of the sweep's %zu cells have run on this machine\n", there, job.cells.size());
}

study::PriceList prices_of(const Job& job, study::SweepFile& file) {
  return study::price_list(file.cells(), job.plan, job.origin, job.scene.scene.tank_size_m[0]);
}

void write_tables(const Job& job, study::SweepFile& file, const AccuracyOptions& options) {
  const auto list = prices_of(job, file);
  std::printf("%s", study::to_markdown(list).c_str());
  if (!options.csv.empty())
    base::write_file_atomically(options.csv, figures::to_csv(study::setting_table(list)));
  if (!options.prices_csv.empty())
    base::write_file_atomically(options.prices_csv, figures::to_csv(study::price_table(list)));
  if (!options.markdown.empty()) base::write_file_atomically(options.markdown, study::to_markdown(list));
  if (!options.html.empty()) base::write_file_atomically(options.html, study::accuracy_page(list, job.plan));
}

/// Chooses a solver setting within a budget of time, and writes its file. The candidates are run again before
/// the choice.
void run_budget(const Job& job, const AccuracyOptions& options) {
  study::BudgetRequest request{job.plan, study::parse_budget(options.budget),
                               study::parse_sweep_error(options.error), job.scene.scene.tank_size_m[0]};
  if (!options.of_method.empty()) request.method = sim::parse_method(options.of_method);
  if (!options.of_n_star.empty()) request.n_star = sim::parse_n_star(options.of_n_star);
  if (options.of_rate > 0) request.frames_per_s = options.of_rate;
  study::SweepFile file(options.database, Open::Read);
  tell_missing(job, file);
  const auto choice = study::choose_setting(
      file.cells(), job.origin, request, [&](const study::SweepCell& cell) { return run(job, cell); },
      [](const std::string& words) { std::printf("%s\n", words.c_str()); });
  base::write_file_atomically(options.out, sim::format_setting_file(choice));
  std::printf("%s: %s\n", options.out.c_str(), sim::describe(choice).c_str());
}

void run_accuracy(const AccuracyOptions& options) {
  check_apart(options.database, {{"--csv", options.csv},
                                 {"--prices-csv", options.prices_csv},
                                 {"--markdown", options.markdown},
                                 {"--html", options.html},
                                 {"--out", options.out}});
  if (!options.out.empty() && options.cell.empty() && options.budget.empty())
    throw base::Error("--out " + options.out, "is written by --cell or --budget only, and neither is given",
                      "add one of them, or leave --out out");
  const Job job = job_of(options);
  if (options.list) return print_list(job);
  if (!options.cell.empty()) return run_one(job, options);
  if (options.database.empty())
    throw base::Error("--db", "is missing", "name the file that stores the sweep");
  if (!options.budget.empty()) return run_budget(job, options);
  study::SweepFile file(options.database, options.table_only ? Open::Read : Open::Create);
  if (options.table_only) {
    tell_missing(job, file);
  } else {
    run_missing(job, file, job.cells);
    if (options.front_seeds > 0)
      run_missing(job, file,
                  study::more_seeds_of_fronts(prices_of(job, file), job.plan, options.front_seeds));
  }
  write_tables(job, file, options);
}

void merge_shards(const AccuracyOptions& options) {
  // Checks all shards before merging the first shard.
  for (const auto& shard : options.shards) study::SweepFile(shard, Open::Read);
  study::SweepFile file(options.database, Open::Create);
  std::int64_t added = 0;
  for (const auto& shard : options.shards) added += file.merge(shard);
  std::printf("%s: %lld cells added from %zu files\n", options.database.c_str(),
              static_cast<long long>(added), options.shards.size());
}

}  // namespace

void add_accuracy_command(CLI::App& app) {
  auto options = std::make_shared<AccuracyOptions>();
  auto* command = app.add_subcommand(
      "accuracy",
      "What accuracy costs in time: error and milliseconds of each setting, and what a knob buys");
  auto* database = command
                       ->add_option("--db", options->database,
                                    "Sweep file, made when missing; cells in it are not run again")
                       ->check([](const std::string& path) {
                         // Some options only read the sweep file: an existing one may be in a folder that
                         // cannot be written.
                         return std::filesystem::is_regular_file(path) ? "" : output_file()(path);
                       });
  command->add_option("--scene", options->scene, "SingleDam, JetImpact or Faucet")->capture_default_str();
  add_n_star(*command, options->n_star);
  add_backend(*command, options->backend);
  command->add_option("--seconds", options->seconds, "Of content, from frame 0, in whole 1/30 s")
      ->check(number_in(0.1, 60))
      ->capture_default_str();
  add_count(*command, "--seeds", options->seeds, 1, 100, "Runs of each setting, from starts an ulp apart");
  add_count(*command, "--front-seeds", options->front_seeds, 0, 100,
            "Then so many starts of the settings that none beats in some error; 0 = no more than the others");
  add_size(*command, options->size, "Also draw each frame at this size, px; saliency then sees the picture");
  command
      ->add_option("--pictures", options->kept,
                   "Size, px, of pictures that are kept and compared, drawn apart from what is timed; none = "
                   "no errors of pictures")
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "Two dozen cells of 256 n_* and half a second");
  auto* list = command->add_flag("--list", options->list, "Only print each cell's key and setting");
  auto* cell = command->add_option("--cell", options->cell, "Only run the cell of this key, into --out");
  auto* out = command->add_option("--out", options->out, "Sweep file of --cell, or setting file of --budget")
                  ->check(output_file());
  cell->needs(out)->excludes(list)->excludes(database);
  auto* table =
      command->add_flag("--table", options->table_only, "Only make the tables, from what --db holds")
          ->excludes(list)
          ->excludes(cell);
  auto* budget = command
                     ->add_option("--budget", options->budget,
                                  "Only choose a setting from what --db holds, into --out: the one of least "
                                  "error with 95 % of its frames within this time, such as 11.1ms")
                     ->needs(out)
                     ->needs(database)
                     ->excludes(list)
                     ->excludes(cell)
                     ->excludes(table);
  command
      ->add_option("--error", options->error,
                   "Error to minimise: front, centre, kinetic, density; picture, fovea, salient, ssim, flip, "
                   "film or flicker")
      ->check(CLI::IsMember(study::sweep_error_names()))
      ->capture_default_str()
      ->needs(budget);
  command->add_option("--of-method", options->of_method, "Choose among settings of this method")
      ->needs(budget);
  command->add_option("--of-n-star", options->of_n_star, "Choose among settings of this size")->needs(budget);
  command
      ->add_option("--of-rate", options->of_rate, "Choose among settings of this many frames/s, such as 60")
      ->check(number_in(1, 1000))
      ->needs(budget);
  const auto add_output = [&](const char* name, std::string& path, const char* words) {
    command->add_option(name, path, words)
        ->check(output_file())
        ->excludes(list)
        ->excludes(cell)
        ->excludes(budget);
  };
  add_output("--csv", options->csv, "File for a row for each setting");
  add_output("--prices-csv", options->prices_csv, "File for a row for each change of one parameter");
  add_output("--markdown", options->markdown, "File for what is printed");
  add_output("--html", options->html, "File for a page with diagrams, fronts and prices");
  auto* merge = command->add_subcommand("merge", "Put the cells of several sweep files into one");
  merge->add_option("--db", options->database, "Sweep file that takes them, made when missing")
      ->required()
      ->check(output_file());
  merge->add_option("shards", options->shards, "Sweep files that --cell wrote")
      ->required()
      ->check(CLI::ExistingFile);
  merge->callback([options] { merge_shards(*options); });
  command->callback([options, merge] {
    if (!merge->parsed()) run_accuracy(*options);
  });
}

}  // namespace apps
