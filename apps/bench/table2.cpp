/// vip-bench table2: the paper's Table 2 (particles, milliseconds and speed-up of the methods), measured on
/// this machine.

#include <epoxy/gl.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "apps/bench/commands.hpp"
#include "apps/bench/table_options.hpp"
#include "apps/common/options.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/measure/cells.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/picture_size.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/text.hpp"
#include "stats/base/timing.hpp"
#include "stats/figures/bar_chart.hpp"
#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace apps {

namespace {

constexpr base::PictureSize picture_size{1280, 720};

struct Table2Options : measure::TableOptions {
  int frames = 300;
  int warm_up = 60;
  std::string methods = "all";  ///< "all", or names separated by commas
  std::string ptpe;             ///< file of a fitted PTPE model (a, b of tau); empty: the paper's model
  stats::PtpeModel model;
};

/// Times of one cell, ms, and numbers of particles: one value per frame without the warm-up frames.
/// saliency_ms, levels_ms, activation_ms and solve_ms come from a second run of the same frames.
struct CellRun {
  std::vector<double> particles, solved, step_ms, render_ms, frame_ms;
  double splits = 0, merges = 0;  ///< per frame
  std::vector<double> saliency_ms, levels_ms, activation_ms, solve_ms;
  /// Mean time of passing the picture to saliency, ms. Contained in step_ms, but not in frame_ms.
  double seen_ms = 0;
  std::vector<double> followed_ms;  ///< frame times from which a measured tau follows, including warm-up
  sim::PictureWay seen_way = sim::PictureWay::None;
};

struct Moments {
  double mean = 0, sd = 0;
};
Moments moments_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Moments out;
  out.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  for (const double v : values) out.sd += (v - out.mean) * (v - out.mean) / n;
  out.sd = std::sqrt(out.sd);
  return out;
}

/// Measures the wall times of all frames. Waits for the device after each step and each picture; within a
/// step only the method itself waits.
CellRun time_frames(const sim::CellScene& scene, const sim::SimulationOptions& choice,
                    const Table2Options& options) {
  const auto made = sim::make_simulation(scene.scene, choice);
  sim::Simulation& fluid = *made;
  measure::Onlooker eye(scene.scene, picture_size);
  CellRun run;
  sim::LevelEvents before;
  for (int frame = 1; frame <= options.frames; ++frame) {
    const double start = base::milliseconds_now();
    eye.look(fluid, sim::gaze_point(scene.scene, frame));
    const double looked = base::milliseconds_now();
    fluid.step_frame();
    fluid.synchronize();
    const double stepped = base::milliseconds_now();
    eye.draw(fluid);
    glFinish();
    const double drawn = base::milliseconds_now();
    run.followed_ms.push_back(drawn - looked);
    fluid.frame_time(run.followed_ms.back());
    if (frame == options.warm_up) before = fluid.report().levels;
    if (frame <= options.warm_up) continue;
    const auto n = static_cast<double>(fluid.particle_count());
    run.particles.push_back(n);
    const auto& temporal = fluid.account().temporal;
    run.solved.push_back(temporal ? static_cast<double>(temporal->active) / n : 1);
    run.step_ms.push_back(stepped - start);
    run.render_ms.push_back(drawn - stepped);
    run.frame_ms.push_back(drawn - looked);
    run.seen_ms += (looked - start) / (options.frames - options.warm_up);
  }
  const sim::LevelEvents after = fluid.report().levels;
  const double frames = options.frames - options.warm_up;
  run.splits = static_cast<double>(after.splits - before.splits) / frames;
  run.merges = static_cast<double>(after.merges - before.merges) / frames;
  sim::check_finite(fluid, scene.name);
  sim::print_guards(
      scene.name + ", " + sim::method_name(choice.method) + ", n_* " + std::to_string(choice.n_star), fluid);
  run.seen_way = fluid.report().seen.way;
  return run;
}

/// Runs the same frames again and waits for the device after each part, to time the parts. A measured
/// tau is computed from the frame times of the first run, so that waiting does not change which particles are
/// solved.
void time_parts(const sim::CellScene& scene, sim::SimulationOptions choice, const Table2Options& options,
                CellRun& run) {
  choice.time_parts = true;
  const auto made = sim::make_simulation(scene.scene, choice);
  sim::Simulation& fluid = *made;
  measure::Onlooker eye(scene.scene, picture_size);
  for (int frame = 1; frame <= options.frames; ++frame) {
    eye.look(fluid, sim::gaze_point(scene.scene, frame));
    fluid.step_frame();
    // Draws and waits here: drawing that is still pending would be timed as saliency of the next frame.
    if (fluid.follows_picture()) eye.draw(fluid);
    glFinish();
    fluid.frame_time(run.followed_ms[static_cast<std::size_t>(frame - 1)]);
    if (frame <= options.warm_up) continue;
    const sim::PartTimes parts = fluid.part_times();
    run.saliency_ms.push_back(parts.saliency_ms);
    run.levels_ms.push_back(parts.levels_ms);
    run.activation_ms.push_back(parts.activation_ms);
    run.solve_ms.push_back(parts.solve_ms);
  }
}

std::vector<std::string> row_of(const sim::CellScene& scene, const measure::CellSize& size,
                                sim::MethodKind method, sim::Preset preset, const std::string& tau_word,
                                const stats::PtpeModel& model, const CellRun& run, double hires_ms) {
  const Moments particles = moments_of(run.particles);
  const double step_ms = moments_of(run.step_ms).mean;
  std::vector<double> intervals_s;
  for (const double ms : run.frame_ms) intervals_s.push_back(1e-3 * ms);
  const stats::FpsMoments fps = stats::fps_moments(intervals_s);
  const double finest = 8.0 * static_cast<double>(size.n_star);
  return {scene.name,
          size.word,
          sim::method_name(method),
          sim::preset_name(preset),
          tau_word,
          figures::number(particles.mean, 0),
          figures::number(particles.sd, 0),
          figures::number(particles.mean / finest, 3),
          figures::number(moments_of(run.solved).mean, 3),
          figures::number(run.splits, 1),
          figures::number(run.merges, 1),
          figures::number(base::quantile(run.frame_ms, 0.5), 3),
          figures::number(step_ms, 3),
          figures::number(base::quantile(run.step_ms, 0.99), 3),
          figures::number(moments_of(run.saliency_ms).mean, 3),
          figures::number(moments_of(run.levels_ms).mean, 3),
          figures::number(moments_of(run.activation_ms).mean, 3),
          figures::number(moments_of(run.solve_ms).mean, 3),
          figures::number(base::quantile(run.render_ms, 0.5), 3),
          figures::number(run.seen_ms, 3),
          sim::picture_way_name(run.seen_way),
          figures::number(fps.sd, 2),
          figures::number(stats::ptpe_tolerance(model, fps), 2),
          figures::number(hires_ms / step_ms, 3)};
}

/// True if `words` is "all" or names the method. Always true for HiRes, because the other methods are
/// compared with HiRes.
bool wanted(sim::MethodKind method, const std::string& words) {
  if (words == "all" || method == sim::MethodKind::HiRes) return true;
  bool found = false;
  for (const std::string& word : base::split(words)) found |= sim::parse_method(word) == method;
  return found;
}

const std::vector<std::string> head{
    "scene",        "n_star",         "method",      "preset",    "tau_rule",      "particles_mean",
    "particles_sd", "share_of_hires", "solved",      "splits",    "merges",        "ms_median",
    "ms_step_mean", "ms_step_p99",    "ms_saliency", "ms_levels", "ms_activation", "ms_solve",
    "ms_render",    "ms_read_back",   "picture_by",  "fps_sd",    "tau",           "speedup"};

constexpr const char* table2_columns_help =
    "solved is the share of the particles that the frame solves; the others rest (temporal acceleration).\n"
    "splits and merges are numbers a frame. ms_median is a frame: step and rendering. ms_step_mean and\n"
    "ms_step_p99 are the wall time of a step: the hand-over of the picture to saliency (ms_read_back is its\n"
    "mean), the step, and one wait at its end. speedup is HiRes' ms_step_mean over the method's. The parts,\n"
    "ms_saliency to ms_solve, are means of a second run of the same frames under a clock that waits for the\n"
    "device between them: they may add up to more than a step.";

/// A row of the table: a method and the source of its tau.
struct RowPlan {
  sim::MethodKind method;
  std::string tau;
};
/// The rows of the table. If --tau is not "live", each accelerated method gets a second row, in which tau
/// follows the measured frame rate.
std::vector<RowPlan> rows_of(const Table2Options& options) {
  std::vector<RowPlan> out;
  for (const auto& traits : sim::all_methods()) {
    if (!wanted(traits.kind, options.methods)) continue;
    out.push_back({traits.kind, options.tau});
    if (traits.temporal && options.tau != "live") out.push_back({traits.kind, "live"});
  }
  return out;
}

void add_rows(const sim::CellScene& scene, const measure::CellSize& size, sim::Preset preset,
              const Table2Options& options, figures::TextTable& table, base::Progress& progress,
              std::size_t& done) {
  std::vector<std::pair<RowPlan, CellRun>> runs;
  double hires_ms = 0;
  for (const auto& row : rows_of(options)) {
    sim::SimulationOptions choice;
    choice.method = row.method;
    choice.n_star = size.n_star;
    choice.backend = sim::choose_backend(options.backend);
    choice.readings = sim::readings_of(preset);
    choice.cache = sim::default_cache_folder();
    choice.temporal.model = options.model;
    choice.temporal.fixed_tau = measure::tau_of(row.tau, scene.name, size.word, row.method);
    auto run = time_frames(scene, choice, options);
    time_parts(scene, choice, options, run);
    if (row.method == sim::MethodKind::HiRes) hires_ms = moments_of(run.step_ms).mean;
    runs.emplace_back(row, std::move(run));
    progress.update(++done);
  }
  for (const auto& [row, run] : runs) {
    table.rows.push_back(row_of(scene, size, row.method, preset, row.tau, options.model, run, hires_ms));
  }
}

void write_outputs(const Table2Options& options, const figures::TextTable& table) {
  if (!options.csv.empty()) base::write_file_atomically(options.csv, figures::to_csv(table));
  if (!options.markdown.empty()) base::write_file_atomically(options.markdown, figures::to_markdown(table));
  if (options.svg_folder.empty()) return;
  base::make_folder(options.svg_folder);
  figures::BarChart chart;
  chart.title = "Speed-up over HiRes: wall time of a step, with the hand-over of the picture";
  chart.unit = "x";
  for (const auto& row : table.rows) {
    const std::string live = row[4] == "live" && options.tau != "live" ? ", tau live" : "";
    chart.bars.push_back({row[0] + " " + row[1] + " " + row[3], row[2] + live, std::stod(row.back())});
  }
  base::write_file_atomically(std::filesystem::path(options.svg_folder) / "table2_speedup.svg",
                              figures::to_svg(chart));
}

void run_table2(const Table2Options& options) {
  const auto scenes = sim::scenes_of(options.scene);
  const auto sizes = measure::sizes_of(options.n_star);
  const auto presets = measure::presets_of(options.preset);
  measure::tau_of(options.tau, scenes.front().name, sizes.front().word, sim::MethodKind::OursTsp);
  auto context = sim::GlContext::make_headless();
  figures::TextTable table{head, {}};
  const std::size_t cells = scenes.size() * sizes.size() * presets.size() * rows_of(options).size();
  base::Progress progress("cells", cells);
  std::size_t done = 0;
  for (const auto& scene : scenes) {
    for (const auto& size : sizes) {
      for (const auto preset : presets) add_rows(scene, size, preset, options, table, progress, done);
    }
  }
  std::printf("%s", figures::to_markdown(table).c_str());
  write_outputs(options, table);
}

}  // namespace

void add_table2_command(CLI::App& app) {
  auto options = std::make_shared<Table2Options>();
  auto* command =
      app.add_subcommand("table2", "The paper's Table 2: particles, milliseconds by part, speed-up");
  command->footer(table2_columns_help);
  add_table_options(*command, *options);
  command->add_option("--ptpe", options->ptpe, ptpe_help);
  add_count(*command, "--frames", options->frames, 2, 100000, "Frames of a cell");
  command->add_option("--methods", options->methods, "all, or names with commas; HiRes runs in any case")
      ->capture_default_str();
  add_count(*command, "--warm-up", options->warm_up, 0, 99999, "Of these, left out of the figures");
  command->callback([options] {
    if (options->warm_up >= options->frames) {
      throw base::Error("--warm-up " + std::to_string(options->warm_up), "leaves no frame to measure",
                        "make it smaller than --frames, which is " + std::to_string(options->frames));
    }
    options->model = load_model(options->ptpe);
    run_table2(*options);
  });
}

}  // namespace apps
