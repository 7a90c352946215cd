/// vip-bench effects: milliseconds per frame that each effect of a scene costs.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <numeric>

#include "apps/bench/commands.hpp"
#include "apps/common/options.hpp"
#include "libsim/measure/cells.hpp"
#include "libsim/measure/effects_cost.hpp"
#include "libsim/measure/effects_levels.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/timing.hpp"

namespace apps {

namespace {

struct EffectsOptions {
  std::string scene = "data/scenes/splash.toml";
  std::string n_star = "4k", method = "HiRes", backend = "auto", tau = "fixed:-6";
  std::string csv, markdown, svg;
  int frames = 60, warm_up = 5, substeps = 0;
  bool levels = false;
  base::PictureSize size{640, 480};
};

sim::SimulationOptions choice_of(const EffectsOptions& options) {
  sim::SimulationOptions out;
  out.method = sim::parse_method(options.method);
  out.n_star = sim::parse_n_star(options.n_star);
  out.backend = sim::choose_backend(options.backend);
  out.temporal.fixed_tau = sim::parse_tau(options.tau);
  out.substeps = options.substeps;
  return out;
}

/// The fluid of one variant of the scene's effects. All variants exist at the same time, so that their frames
/// are timed in turn.
struct Running {
  measure::EffectCost cost;
  std::unique_ptr<sim::Simulation> fluid;
};

Running start(const measure::EffectVariant& variant, const sim::SimulationOptions& choice, int warm_up) {
  Running out{.cost = {.name = variant.name}, .fluid = nullptr};
  const auto before = sim::device_bytes_taken(choice.backend);
  out.fluid = measure::make_settled(variant.scene, choice);
  for (int frame = 0; frame < warm_up; ++frame) out.fluid->step_frame();
  out.fluid->synchronize();
  if (const auto after = sim::device_bytes_taken(choice.backend))
    out.cost.device_bytes = static_cast<double>(*after - *before);
  out.cost.column_bytes = static_cast<double>(out.fluid->particle_bytes());
  return out;
}

void time_frame(Running& running, int frames) {
  sim::Simulation& fluid = *running.fluid;
  const double begin = base::milliseconds_now();
  fluid.step_frame();
  fluid.synchronize();
  const double ms = base::milliseconds_now() - begin;
  fluid.frame_time(ms);
  running.cost.ms_frame += ms / frames;
  running.cost.particles += static_cast<double>(fluid.particle_count()) / frames;
}

bool same(const std::vector<sim::ParticleState>& a, const std::vector<sim::ParticleState>& b) {
  const auto equal = [](const sim::ParticleState& p, const sim::ParticleState& q) {
    return p.id == q.id && p.level == q.level && p.x_m == q.x_m && p.y_m == q.y_m && p.z_m == q.z_m &&
           p.vx_m_s == q.vx_m_s && p.vy_m_s == q.vy_m_s && p.vz_m_s == q.vz_m_s;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), equal);
}

/// Counts the kernel launches of one more frame, which is not timed.
void count_launches(Running& running) {
  running.fluid->profile_launches(true);
  running.fluid->step_frame();
  for (const auto& pass : running.fluid->launch_times()) running.cost.launches += pass.launches;
  running.fluid->profile_launches(false);
}

std::vector<measure::EffectCost> costs_of(const sim::Scene& scene, const EffectsOptions& options,
                                          const sim::SimulationOptions& choice) {
  const auto variants = measure::variants_of(scene);
  std::vector<Running> all;
  for (const measure::EffectVariant& variant : variants)
    all.push_back(start(variant, choice, options.warm_up));
  base::Progress progress("frames", static_cast<std::size_t>(options.frames));
  for (int frame = 0; frame < options.frames; ++frame) {
    for (Running& running : all) time_frame(running, options.frames);
    progress.update(static_cast<std::size_t>(frame) + 1);
  }
  const auto bare = all.front().fluid->read_state();
  std::vector<measure::EffectCost> costs;
  for (Running& running : all) {
    const std::string place = scene.name + ", effects: " + running.cost.name;
    sim::check_finite(*running.fluid, place);
    sim::print_guards(place, *running.fluid);
    running.cost.same_state = same(bare, running.fluid->read_state());
    count_launches(running);
    costs.push_back(running.cost);
  }
  return costs;
}

template <class Costs>
void tell(const EffectsOptions& options, const measure::EffectsRun& run, const Costs& costs) {
  const figures::TextTable table = measure::to_table(run, costs);
  std::printf("%s", figures::to_markdown(table).c_str());
  if (!options.csv.empty()) base::write_file_atomically(options.csv, figures::to_csv(table));
  if (!options.markdown.empty()) base::write_file_atomically(options.markdown, figures::to_markdown(table));
  if (!options.svg.empty()) base::write_file_atomically(options.svg, measure::to_svg(run, costs));
}

void run_effects(const EffectsOptions& options) {
  check_apart("", {{"--csv", options.csv}, {"--markdown", options.markdown}, {"--svg", options.svg}});
  const sim::Scene scene = sim::read_scene(base::find_input(options.scene));
  sim::SimulationOptions choice = choice_of(options);
  // All variants use the same substeps, so that the cost of an effect contains no cost of shorter substeps.
  choice.substeps = sim::least_substeps(scene, choice);
  const measure::EffectsRun run{scene.name,
                                sim::method_name(choice.method),
                                sim::backend_name(choice.backend),
                                options.n_star,
                                options.frames,
                                choice.substeps};
  if (!options.levels) return tell(options, run, costs_of(scene, options, choice));
  const measure::LevelRuns runs{choice, options.warm_up, options.frames, options.size};
  tell(options, run, measure::run_levels(measure::level_variants_of(scene), runs));
}

constexpr const char* effects_columns_help =
    "A row for the bare scene, for each of its effects alone (with what it needs), for all, and for all\n"
    "with coefficients of 0. Their fluids step in turn, with the same number of substeps: the least that all "
    "the\n"
    "effects together allow. What is added is over the bare scene. No picture is drawn. column_bytes count\n"
    "the particles' columns and what saliency, temporal acceleration, nozzles, outlets and foam keep; the\n"
    "vectors of viscosity's conjugate gradients and lists of neighbours are in neither but in\n"
    "device_bytes, all of the device's memory (- on the CPU). same_state: after the timed frames all\n"
    "particles are where they are without effects, bit for bit. Water with an effect is other water, so its\n"
    "time holds what that changed too.\n"
    "--levels: rows for each effect that has a coarsest_level: without it (none), at all levels, at fewer,\n"
    "and at all from a start whose coordinates lie an ulp away. They look at the scene's gaze point and see\n"
    "their own pictures. ms_passes: the effect's own passes; saved_percent: of what they take at all "
    "levels.\n"
    "Milliseconds are medians. A clock stands round each pass: frames on a GPU take longer. psnr_db,\n"
    "ssim and flip_percent are of four pictures of the timed frames against those at all levels; the moved\n"
    "start tells how much of a change is chance.";

}  // namespace

void add_effects_command(CLI::App& app) {
  auto options = std::make_shared<EffectsOptions>();
  auto* command = app.add_subcommand("effects", "What each of a scene's effects adds to a frame");
  command->footer(effects_columns_help);
  command->add_option("scene", options->scene, "Scene file that lists effects")->capture_default_str();
  add_n_star(*command, options->n_star);
  add_method(*command, options->method);
  add_backend(*command, options->backend);
  command->add_option("--tau", options->tau, "Tolerance of Ours-TSp: live or fixed:X in frames/s")
      ->capture_default_str();
  add_count(*command, "--substeps", options->substeps, 0, 1000,
            "Substeps in every frame; 0 = the least that the effects and the scene allow");
  add_count(*command, "--frames", options->frames, 1, 100000, "Timed frames of each variant");
  add_count(*command, "--warm-up", options->warm_up, 0, 10000, "Untimed frames before");
  auto* levels = command->add_flag(
      "--levels", options->levels,
      "What it saves and changes to keep an effect to fine levels; --method Ours or another with levels");
  add_size(*command, options->size, "Pictures of --levels, px")->needs(levels);
  command->add_option("--csv", options->csv, "File for a row for each variant")->check(output_file());
  command->add_option("--markdown", options->markdown, "File for the table")->check(output_file());
  command->add_option("--svg", options->svg, "File for a picture with a bar for each variant")
      ->check(output_file());
  command->callback([options] { run_effects(*options); });
}

}  // namespace apps
