/// vip-bench table2: the paper's Table 2 on this machine.

#include <epoxy/gl.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <sstream>

#include "apps/bench/bar_chart.hpp"
#include "apps/bench/cells.hpp"
#include "apps/bench/commands.hpp"
#include "apps/bench/timing.hpp"
#include "apps/common/finite_water.hpp"
#include "apps/common/fluid_picture.hpp"
#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/fps_window.hpp"
#include "stats/ptpe/ptpe.hpp"

namespace apps {

namespace {

constexpr int width_px = 1280;
constexpr int height_px = 720;

struct Table2Options : TableOptions {
  int frames = 300;
  int warm_up = 60;
  std::string methods = "all";  ///< or names separated by commas
  std::string ptpe;             ///< fitted.toml; empty: the paper's model
  stats::PtpeModel model;
};

/// One value a frame of one cell.
struct CellRun {
  std::vector<double> particles, saliency_ms, levels_ms, activation_ms, solve_ms, render_ms, frame_ms, active;
  double seen_ms = 0;  ///< mean of handing the picture to saliency, outside frame_ms
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

CellRun run_cell(const CellScene& scene, const sim::SimulationOptions& choice, const Table2Options& options) {
  const auto fluid = sim::make_simulation(scene.scene, choice);
  FluidPicture picture(scene.scene);
  const sim::Offscreen target(width_px, height_px);
  const sim::View view = sim::make_view(scene.scene.view, width_px, height_px);
  CellRun run;
  for (int frame = 1; frame <= options.frames; ++frame) {
    const double start = milliseconds_now();
    picture.look(*fluid, view, gaze_at(scene.scene.view, sim::gaze_point(scene.scene, frame)));
    const double looked = milliseconds_now();
    fluid->step_frame();
    fluid->synchronize();
    const double stepped = milliseconds_now();
    picture.draw(*fluid, view, target.framebuffer());
    glFinish();
    const double drawn = milliseconds_now();
    fluid->frame_time(drawn - looked);
    if (frame <= options.warm_up) continue;
    const sim::PartTimes parts = fluid->part_times();
    run.particles.push_back(static_cast<double>(fluid->particle_count()));
    run.saliency_ms.push_back(parts.saliency_ms);
    run.levels_ms.push_back(parts.levels_ms);
    run.activation_ms.push_back(parts.activation_ms);
    run.solve_ms.push_back(parts.solve_ms);
    run.render_ms.push_back(drawn - stepped);
    run.frame_ms.push_back(drawn - looked);
    run.seen_ms += (looked - start) / (options.frames - options.warm_up);
  }
  check_finite(*fluid, scene.name);
  run.seen_way = fluid->report().seen.way;
  return run;
}

/// What the speed-up compares: everything but rendering, median over frames.
double solver_ms(const CellRun& run) {
  std::vector<double> sum(run.frame_ms.size());
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i] = run.saliency_ms[i] + run.levels_ms[i] + run.activation_ms[i] + run.solve_ms[i];
  }
  return quantile(sum, 0.5);
}

std::vector<std::string> row_of(const CellScene& scene, const CellSize& size, sim::MethodKind method,
                                sim::Preset preset, const std::string& tau_word,
                                const stats::PtpeModel& model, const CellRun& run, double hires_ms) {
  const Moments particles = moments_of(run.particles);
  std::vector<double> intervals_s;
  for (const double ms : run.frame_ms) intervals_s.push_back(1e-3 * ms);
  const stats::FpsMoments fps = stats::fps_moments(intervals_s);
  const double finest = 8.0 * static_cast<double>(size.n_star);
  return {scene.name,
          size.word,
          sim::method_name(method),
          sim::preset_name(preset),
          tau_word,
          number(particles.mean, 0),
          number(particles.sd, 0),
          number(particles.mean / finest, 3),
          number(quantile(run.frame_ms, 0.5), 3),
          number(quantile(run.saliency_ms, 0.5), 3),
          number(quantile(run.levels_ms, 0.5), 3),
          number(quantile(run.activation_ms, 0.5), 3),
          number(quantile(run.solve_ms, 0.5), 3),
          number(quantile(run.render_ms, 0.5), 3),
          number(run.seen_ms, 3),
          picture_way_name(run.seen_way),
          number(fps.sd, 2),
          number(stats::ptpe_tolerance(model, fps), 2),
          number(hires_ms / solver_ms(run), 3)};
}

/// HiRes is what the others are compared with.
bool wanted(sim::MethodKind method, const std::string& words) {
  if (words == "all" || method == sim::MethodKind::HiRes) return true;
  bool found = false;
  std::istringstream stream(words);
  for (std::string word; std::getline(stream, word, ',');) found |= sim::parse_method(word) == method;
  return found;
}

const std::vector<std::string> head{
    "scene",        "n_star",         "method",       "preset",      "tau_rule",  "particles_mean",
    "particles_sd", "share_of_hires", "ms_median",    "ms_saliency", "ms_levels", "ms_activation",
    "ms_solve",     "ms_render",      "ms_read_back", "picture_by",  "fps_sd",    "tau",
    "speedup"};

/// A row: a method, and what its tau goes by.
struct RowPlan {
  sim::MethodKind method;
  std::string tau;
};
/// Where tau is given, a second row of each accelerated method shows what the frame rate alone would do.
std::vector<RowPlan> rows_of(const Table2Options& options) {
  std::vector<RowPlan> out;
  for (const auto& traits : sim::all_methods()) {
    if (!wanted(traits.kind, options.methods)) continue;
    out.push_back({traits.kind, options.tau});
    if (traits.temporal && options.tau != "live") out.push_back({traits.kind, "live"});
  }
  return out;
}

void add_rows(const CellScene& scene, const CellSize& size, sim::Preset preset, const Table2Options& options,
              TextTable& table, Progress& progress, std::size_t& done) {
  std::vector<std::pair<RowPlan, CellRun>> runs;
  double hires_ms = 0;
  for (const auto& row : rows_of(options)) {
    sim::SimulationOptions choice;
    choice.method = row.method;
    choice.n_star = size.n_star;
    choice.backend = sim::choose_backend(options.backend);
    choice.readings = sim::readings_of(preset);
    choice.cache = sim::default_cache_folder();
    choice.time_parts = true;
    choice.temporal.model = options.model;
    choice.temporal.fixed_tau = tau_of(row.tau, scene.name, size.word, row.method);
    runs.emplace_back(row, run_cell(scene, choice, options));
    if (row.method == sim::MethodKind::HiRes) hires_ms = solver_ms(runs.back().second);
    progress.update(++done);
  }
  for (const auto& [row, run] : runs) {
    table.rows.push_back(row_of(scene, size, row.method, preset, row.tau, options.model, run, hires_ms));
  }
}

void write_outputs(const Table2Options& options, const TextTable& table) {
  if (!options.csv.empty()) base::write_file_atomically(options.csv, to_csv(table));
  if (!options.markdown.empty()) base::write_file_atomically(options.markdown, to_markdown(table));
  if (options.svg_folder.empty()) return;
  make_folder(options.svg_folder);
  BarChart chart;
  chart.title = "Speed-up over HiRes: saliency, levels, activation and solve";
  chart.unit = "x";
  for (const auto& row : table.rows) {
    const std::string live = row[4] == "live" && options.tau != "live" ? ", tau live" : "";
    chart.bars.push_back({row[0] + " " + row[1] + " " + row[3], row[2] + live, std::stod(row.back())});
  }
  base::write_file_atomically(std::filesystem::path(options.svg_folder) / "table2_speedup.svg",
                              to_svg(chart));
}

void run_table2(const Table2Options& options) {
  const auto scenes = scenes_of(options.scene);
  const auto sizes = sizes_of(options.n_star);
  const auto presets = presets_of(options.preset);
  tau_of(options.tau, scenes.front().name, sizes.front().word, sim::MethodKind::OursTsp);
  auto context = sim::GlContext::make_headless();
  TextTable table{head, {}};
  const std::size_t cells = scenes.size() * sizes.size() * presets.size() * rows_of(options).size();
  Progress progress("cells", cells);
  std::size_t done = 0;
  for (const auto& scene : scenes) {
    for (const auto& size : sizes) {
      for (const auto preset : presets) add_rows(scene, size, preset, options, table, progress, done);
    }
  }
  std::printf("%s", to_markdown(table).c_str());
  write_outputs(options, table);
}

}  // namespace

void add_table2_command(CLI::App& app) {
  auto options = std::make_shared<Table2Options>();
  auto* command =
      app.add_subcommand("table2", "The paper's Table 2: particles, milliseconds by part, speed-up");
  add_table_options(*command, *options);
  command->add_option("--ptpe", options->ptpe, ptpe_help);
  add_count(*command, "--frames", options->frames, 2, 100000, "Frames of a cell");
  command->add_option("--methods", options->methods, "all, or names with commas; HiRes runs in any case")
      ->capture_default_str();
  add_count(*command, "--warm-up", options->warm_up, 0, 99999, "Of these, left out of the figures");
  command->callback([options] {
    if (options->warm_up >= options->frames) {
      throw base::Error("--warm-up", "leaves no frame to measure", "make it smaller than --frames");
    }
    options->model = load_model(options->ptpe);
    run_table2(*options);
  });
}

}  // namespace apps
