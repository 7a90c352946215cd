/// vip-bench growth: how the milliseconds of a substep grow with the number of particles.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>

#include "apps/bench/commands.hpp"
#include "apps/common/options.hpp"
#include "libsim/measure/growth_table.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/timing.hpp"

namespace apps {

namespace {

struct GrowthOptions {
  std::string scene = "data/scenes/single_dam.toml";
  std::string n_star = "4k,8k,16k,32k";
  std::string method = "HiRes", backend = "auto", tau = "fixed:-6";
  std::string csv, svg;
  int frames = 100;
  int warm_up = 5;
};

measure::GrowthRow run_size(const sim::Scene& scene, const measure::CellSize& size,
                            const GrowthOptions& options, base::Progress& progress, std::size_t& done) {
  sim::SimulationOptions choice;
  choice.method = sim::parse_method(options.method);
  choice.n_star = size.n_star;
  choice.backend = sim::choose_backend(options.backend);
  choice.temporal.fixed_tau = sim::parse_tau(options.tau);
  const auto taken_before = sim::device_bytes_taken(choice.backend);
  const auto fluid = measure::make_settled(scene, choice);
  for (int frame = 0; frame < options.warm_up; ++frame) fluid->step_frame();
  fluid->synchronize();

  std::vector<double> frame_ms, substep_ms;
  measure::Substeps substeps;
  measure::Accuracy accuracy;
  measure::GrowthRow out{.n_star = size.word};
  const int stride = measure::tenth_of(options.frames, choice.method, choice.readings);
  for (int frame = 0; frame < options.frames; ++frame) {
    const double start = base::milliseconds_now();
    fluid->step_frame();
    fluid->synchronize();
    frame_ms.push_back(base::milliseconds_now() - start);
    fluid->frame_time(frame_ms.back());
    substeps.add(fluid->substeps());
    substep_ms.push_back(frame_ms.back() / fluid->substeps().taken);
    out.particles += static_cast<double>(fluid->particle_count()) / options.frames;
    if (frame % stride == stride - 1) accuracy.add(fluid->report());
    progress.update(++done);
  }
  const std::string place = scene.name + ", n_* " + size.word;
  sim::check_finite(*fluid, place);
  sim::print_guards(place, *fluid);
  const double all_ms = std::accumulate(frame_ms.begin(), frame_ms.end(), 0.0);
  out.substeps_mean = substeps.mean(options.frames);
  out.ms_substep_mean = all_ms / substeps.taken;
  out.ms_substep_p99 = base::quantile(substep_ms, 0.99);
  out.ms_frame_mean = all_ms / options.frames;
  out.density_error_mean = accuracy.error_mean;
  const auto particles = static_cast<double>(fluid->particle_count());
  out.column_bytes = static_cast<double>(fluid->particle_bytes()) / particles;
  if (const auto taken = sim::device_bytes_taken(choice.backend))
    out.device_bytes = static_cast<double>(*taken - *taken_before) / particles;
  return out;
}

/// base::Error unless there are at least two different sizes, which the exponent needs.
void check_sizes(const std::string& words, const std::vector<measure::CellSize>& sizes) {
  const auto other = [&](const measure::CellSize& size) { return size.n_star != sizes.front().n_star; };
  if (std::any_of(sizes.begin(), sizes.end(), other)) return;
  throw base::Error("--n-star " + words, "names one size; the exponent of growth needs two",
                    "write two or more, such as 4k,8k,16k");
}

void run_growth(const GrowthOptions& options) {
  check_apart("", {{"--csv", options.csv}, {"--svg", options.svg}});
  const sim::Scene scene = sim::read_scene(base::find_input(options.scene));
  const auto sizes = measure::sizes_of(options.n_star);
  check_sizes(options.n_star, sizes);
  base::Progress progress("frames", sizes.size() * static_cast<std::size_t>(options.frames));
  std::size_t done = 0;
  std::vector<measure::GrowthRow> rows;
  for (const auto& size : sizes) rows.push_back(run_size(scene, size, options, progress, done));
  const measure::Growth growth = measure::growth_of(rows);
  const measure::GrowthRun run{scene.name, sim::method_name(sim::parse_method(options.method)),
                               sim::backend_name(sim::choose_backend(options.backend)), options.frames};
  const figures::TextTable table = measure::to_table(run, rows, growth);
  std::printf("%s\nms a substep over particles: %s\n", figures::to_markdown(table).c_str(),
              measure::in_words(growth, rows.size()).c_str());
  if (!options.csv.empty()) base::write_file_atomically(options.csv, figures::to_csv(table));
  if (!options.svg.empty()) base::write_file_atomically(options.svg, measure::to_svg(run, rows, growth));
}

constexpr const char* growth_columns_help =
    "A substep's milliseconds are a frame's wall time, with one wait at its end, over its substeps; no\n"
    "picture is drawn, and saliency sees none. exponent is the least-squares slope of log(ms_substep_mean)\n"
    "over log(particles_mean), exponent_se its standard error (- with two sizes). column_bytes_per_particle\n"
    "counts the particles' columns and what saliency, temporal acceleration, nozzles and outlets keep;\n"
    "neighbour lists, cells and the grids of the pressure are not in it. device_bytes_per_particle is what\n"
    "the device's memory holds after the run above what it held before it (- on the CPU).\n"
    "density_error_mean is the mean of max(rho/rho_0 - 1, 0) over some ten states.";

}  // namespace

void add_growth_command(CLI::App& app) {
  auto options = std::make_shared<GrowthOptions>();
  auto* command = app.add_subcommand("growth", "How the milliseconds of a substep grow with the particles");
  command->footer(growth_columns_help);
  command->add_option("scene", options->scene, "Scene file")->capture_default_str();
  command
      ->add_option("--n-star", options->n_star,
                   "Number of particles if all were at the coarsest level; two sizes or more, separated by "
                   "commas; k = 1,024")
      ->capture_default_str();
  add_method(*command, options->method);
  add_backend(*command, options->backend);
  command->add_option("--tau", options->tau, "Tolerance of Ours-TSp: live or fixed:X in frames/s")
      ->capture_default_str();
  add_count(*command, "--frames", options->frames, 1, 100000, "Timed frames of a size");
  add_count(*command, "--warm-up", options->warm_up, 0, 10000, "Untimed frames before");
  command->add_option("--csv", options->csv, "File for a row for each size")->check(output_file());
  command->add_option("--svg", options->svg, "File for a picture on logarithmic axes")->check(output_file());
  command->callback([options] { run_growth(*options); });
}

}  // namespace apps
