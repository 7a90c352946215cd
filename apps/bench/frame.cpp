#include <omp.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "apps/bench/account_json.hpp"
#include "apps/bench/cells.hpp"
#include "apps/bench/commands.hpp"
#include "apps/bench/render_timer.hpp"
#include "apps/bench/timed_run.hpp"
#include "apps/bench/timing.hpp"
#include "apps/common/finite_water.hpp"
#include "apps/common/fluid_stimulus.hpp"
#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/simulation.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

struct FrameOptions {
  std::string scene = "data/scenes/single_dam.toml";
  std::string method = "HiRes";
  std::string n_star = "4k";
  std::string backend = "auto";
  std::string tau = "live";
  std::string rate, ptpe;
  std::string json;
  std::string save_state;
  int frames = 100;
  int warm_up = 5;
  int measure_every = 0;
  sim::SimulationOptions
      fluid;  ///< the solver's numbers; method, n_* and back end are read from the words above
  bool no_render = false;
  bool passes = false;
  bool look = false;
  PictureSize size{1280, 720};
  int views = 1;
};

std::unique_ptr<sim::Simulation> make_fluid(const sim::Scene& scene, const FrameOptions& options) {
  sim::SimulationOptions out = options.fluid;
  out.method = sim::parse_method(options.method);
  out.n_star = sim::parse_n_star(options.n_star);
  out.backend = sim::choose_backend(options.backend);
  out.temporal.fixed_tau = sim::parse_tau(options.tau);
  if (!options.rate.empty()) out.temporal.fixed_rate = sim::parse_frame_rate(options.rate);
  return make_settled(scene, std::move(out));
}

/// Support radius (4 r) over rest spacing of the first particle.
double h_over_d(const sim::Simulation& fluid) {
  std::vector<sim::RenderParticle> particles;
  fluid.read_particles(particles);
  return particles.empty() ? 0 : 4 * static_cast<double>(particles.front().radius_m) / fluid.spacing_m();
}

/// The pictures beside the solver, or why there are none.
struct Pictures {
  std::unique_ptr<RenderTimer> timer;
  std::string left_out;
};

Pictures make_pictures(const sim::Scene& scene, const FrameOptions& options) {
  const PictureSize size = options.size;
  if (options.no_render) return {nullptr, "--no-render"};
  std::optional<sim::GlContext> context;
  try {
    context.emplace(sim::GlContext::make_headless());
  } catch (const base::Error& error) {
    if (options.look) throw;
    return {nullptr, error.what()};
  }
  return {std::make_unique<RenderTimer>(std::move(*context), scene, size, options.views), ""};
}

/// What each frame's account says, and the share of particles solved over all of them.
struct Accounts {
  nlohmann::json all = nlohmann::json::array();
  double solved = 0;
  void add(const sim::Simulation& fluid, double frame_dt_s) {
    const auto facts = to_facts(fluid.frame() * frame_dt_s, fluid.account());
    all.push_back(account_json(fluid.frame(), facts));
    const double share = facts.tolerance ? facts.tolerance->active_fraction : 1;
    solved += (share - solved) / static_cast<double>(all.size());
  }
};

nlohmann::json run_frames(const FrameOptions& options) {
  const sim::Scene scene = sim::read_scene(base::find_input(options.scene));
  const Pictures pictures = make_pictures(scene, options);
  const auto fluid = make_fluid(scene, options);
  for (int frame = 0; frame < options.warm_up; ++frame) fluid->step_frame();
  fluid->synchronize();
  if (pictures.timer) pictures.timer->warm_up(*fluid);

  fluid->profile_launches(options.passes);
  std::vector<double> solve_ms, frame_ms;
  Accuracy accuracy;
  Accounts accounts;
  Progress progress("frames", static_cast<std::size_t>(options.frames));
  const int stride = options.measure_every > 0 ? options.measure_every : tenth_of(options.frames);
  Substeps substeps;
  for (int frame = 0; frame < options.frames; ++frame) {
    const double start = milliseconds_now();
    if (options.look) pictures.timer->look(*fluid);
    fluid->step_frame();
    fluid->synchronize();
    solve_ms.push_back(milliseconds_now() - start);
    substeps.add(fluid->substeps());
    if (pictures.timer) {
      const auto times = pictures.timer->draw(*fluid);
      frame_ms.push_back(solve_ms.back() + times.transfer + times.render);
    }
    fluid->frame_time(pictures.timer ? frame_ms.back() : solve_ms.back());
    accounts.add(*fluid, options.fluid.frame_dt_s > 0 ? options.fluid.frame_dt_s : scene.frame_dt_s);
    if (frame % stride == stride - 1) accuracy.add(fluid->report());
    progress.update(static_cast<std::size_t>(frame) + 1);
  }
  nlohmann::json launches = nlohmann::json::array();
  for (const auto& pass : fluid->launch_times()) {
    launches.push_back({{"pass", pass.label},
                        {"launches_a_frame", static_cast<double>(pass.launches) / options.frames},
                        {"ms_a_frame", pass.ms / options.frames}});
  }
  check_finite(*fluid, options.scene);
  if (!options.save_state.empty()) fluid->save_state(options.save_state);
  const auto report = fluid->report();
  const double mean =
      std::accumulate(solve_ms.begin(), solve_ms.end(), 0.0) / static_cast<double>(solve_ms.size());
  nlohmann::json result{
      {"program", "vip-bench frame"},
      {"version", base::version()},
      {"scene", scene.name},
      {"scene_sha256", scene.sha256},
      {"method", options.method},
      {"n_star", options.n_star},
      {"backend", sim::backend_name(sim::choose_backend(options.backend))},
      {"threads", omp_get_max_threads()},
      {"frames", options.frames},
      {"particles", fluid->particle_count()},
      {"solve_ms_mean", mean},
      {"solve_ms_median", quantile(solve_ms, 0.5)},
      {"solve_ms_p95", quantile(solve_ms, 0.95)},
      {"solve_ms_p99", quantile(solve_ms, 0.99)},
      {"h_over_d", h_over_d(*fluid)},
      {"neighbours_mean", accuracy.neighbours_mean},
      {"density_error_mean", accuracy.error_mean},
      {"density_max", accuracy.density_max},
      {"states_measured", accuracy.samples},
      {"substeps_mean", substeps.mean(options.frames)},
      {"substeps_most", substeps.most},
      {"frames_short_of_substeps", substeps.bound},
      {"speed_max_m_s", report.speed_max_m_s},
      {"particle_bytes", fluid->particle_bytes()},
      {"temporal",
       {{"model", {{"a", options.fluid.temporal.model.a}, {"b", options.fluid.temporal.model.b}}},
        {"tau_given", options.rate.empty() ? options.tau : "rate:" + options.rate},
        {"tau_fps", or_null(report.temporal.tau)},
        {"beta", report.temporal.beta},
        {"solved_share_mean", accounts.solved}}},
      {"guards",
       {{"speed_limited", report.guards.speed_limited},
        {"coincident_pairs", report.guards.coincident_pairs},
        {"not_finite", report.guards.not_finite},
        {"neighbours_dropped", report.guards.neighbours_dropped},
        {"wall_projected", report.guards.wall_projected},
        {"nozzle_waited", report.guards.nozzle_waited}}},
      {"divergence", divergence_json(fluid->divergence())},
      {"accounts", accounts.all},
      {"launches", launches},
      {"schedule", fluid->explain()}};
  if (pictures.timer) {
    result.update(pictures.timer->figures());
    result["frame_ms_median"] = quantile(frame_ms, 0.5);
    result["frame_ms_p95"] = quantile(frame_ms, 0.95);
    result["frame_ms_p99"] = quantile(frame_ms, 0.99);
  } else {
    result["render_left_out"] = pictures.left_out;
  }
  return result;
}

void print_table(const nlohmann::json& result) {
  std::printf("%s %s n_* %s on %s: %lld particles, %d frames\n", result["scene"].get<std::string>().c_str(),
              result["method"].get<std::string>().c_str(), result["n_star"].get<std::string>().c_str(),
              result["backend"].get<std::string>().c_str(), result["particles"].get<long long>(),
              result["frames"].get<int>());
  std::printf("  solve        %8.3f ms a frame (median), %.3f mean, %.3f p95, %.3f p99\n",
              result["solve_ms_median"].get<double>(), result["solve_ms_mean"].get<double>(),
              result["solve_ms_p95"].get<double>(), result["solve_ms_p99"].get<double>());
  if (result.contains("render_left_out")) {
    std::printf("  render       left out: %s\n", result["render_left_out"].get<std::string>().c_str());
  } else {
    print_render_figures(result);
    std::printf(
        "  frame        %8.3f ms (median), %.3f p95, %.3f p99: solve, transfer and render one after "
        "another\n",
        result["frame_ms_median"].get<double>(), result["frame_ms_p95"].get<double>(),
        result["frame_ms_p99"].get<double>());
  }
  std::printf("  h/d          %8.3f\n  neighbours   %8.2f mean within h\n", result["h_over_d"].get<double>(),
              result["neighbours_mean"].get<double>());
  std::printf("  density      %8.4f %% mean of max(rho/rho_0 - 1, 0), max rho/rho_0 %.3f\n",
              100 * result["density_error_mean"].get<double>(), result["density_max"].get<double>());
  const auto& temporal = result["temporal"];
  std::printf(
      "  substeps     %8.2f a frame on average, %d at most; %d frames asked for more than were allowed\n",
      result["substeps_mean"].get<double>(), result["substeps_most"].get<int>(),
      result["frames_short_of_substeps"].get<int>());
  std::printf("  temporal     tau %s frames/s (%s), beta %.3f, %.2f %% of the particles solved\n",
              temporal["tau_fps"].is_null() ? "unknown" : temporal["tau_fps"].dump().c_str(),
              temporal["tau_given"].get<std::string>().c_str(), temporal["beta"].get<double>(),
              100 * temporal["solved_share_mean"].get<double>());
  std::printf("  guards       %s\n", result["guards"].dump().c_str());
  if (const auto& first = result["divergence"]; !first.is_null())
    std::printf("  divergence   %s\n", first["in_words"].get<std::string>().c_str());
  for (const auto& pass : result["launches"]) {
    std::printf("  %-32s %8.4f ms a frame in %6.1f launches\n", pass["pass"].get<std::string>().c_str(),
                pass["ms_a_frame"].get<double>(), pass["launches_a_frame"].get<double>());
  }
}

}  // namespace

void add_frame_command(CLI::App& app) {
  auto options = std::make_shared<FrameOptions>();
  auto* command = app.add_subcommand("frame", "Milliseconds a frame of one scene and method");
  command->add_option("scene", options->scene, "Scene file")->capture_default_str();
  add_method(*command, options->method);
  add_n_star(*command, options->n_star);
  add_backend(*command, options->backend);
  auto* tau = command->add_option("--tau", options->tau, "Tolerance of Ours-TSp: live or fixed:X in frames/s")
                  ->capture_default_str();
  command
      ->add_option("--rate", options->rate,
                   "Mean and standard deviation of the frame rate that its tau follows from, as in a study's "
                   "cell: 16.9,3.2")
      ->excludes(tau);
  command->add_option("--ptpe", options->ptpe, ptpe_help);
  command->add_flag("--temporal", options->fluid.temporal.always,
                    "Temporal acceleration also for a method without it");
  add_count(*command, "--frames", options->frames, 1, 100000, "Timed frames");
  add_count(*command, "--warm-up", options->warm_up, 0, 10000, "Untimed frames before");
  auto* substeps = command
                       ->add_option("--substeps", options->fluid.substeps,
                                    "Substeps in every frame; 0 = as many as the fastest particle asks for")
                       ->check(CLI::Range(0, 64));
  command->add_option("--iterations", options->fluid.iterations, "Projections a substep; 0 = the scene's")
      ->check(CLI::Range(0, 64));
  command->add_option("--dt", options->fluid.frame_dt_s, "Frame step in s; the scene's when left out")
      ->check(number_in(1e-5, 1.0));
  command->add_option("--relaxation", options->fluid.relaxation, "Constraint relaxation")
      ->check(number_in(0.0, 100.0));
  command->add_option("--tensile", options->fluid.tensile, "s_corr strength")->check(number_in(0.0, 100.0));
  command
      ->add_option("--viscosity", options->fluid.viscosity_m2_s,
                   "Kinematic viscosity in m2/s; the scene's when left out")
      ->check(number_in(0.0, 1e3));
  command
      ->add_option("--courant", options->fluid.courant,
                   "Way of the fastest particle in a substep at most, in h; the scene's when left out")
      ->check(number_in(0.05, 4.0))
      ->excludes(substeps);
  command
      ->add_option("--most-substeps", options->fluid.most_substeps,
                   "Substeps a frame at most while the fastest particle is followed")
      ->check(CLI::Range(1, 1000))
      ->excludes(substeps);
  command->add_option("--momentum", options->fluid.momentum, "Share of the last projection taken again")
      ->check(number_in(0.0, 100.0));
  command
      ->add_option("--coarse-cycles", options->fluid.coarse_cycles,
                   "V-cycles of the coarse pressure; 0 = none")
      ->check(CLI::Range(0, 16));
  command->add_option("--coarse-edge", options->fluid.coarse_edge, "Edge of its cells in h")
      ->check(number_in(0.5, 8.0));
  command
      ->add_option("--resume", options->fluid.resume_from,
                   "Go on from a state that --save-state wrote, with the same scene and options")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--save-state", options->save_state, "Write the state after the last frame to this file")
      ->check(output_file());
  add_count(*command, "--measure-every", options->measure_every, 0, 100000,
            "Measure the density every so many frames, untimed; 0 = ten times");
  command->add_flag("--passes", options->passes, "Also time every launch of the solver (slows it down)");
  auto* no_render = command->add_flag("--no-render", options->no_render, "Time the solver alone");
  command
      ->add_flag("--look", options->look,
                 "Let the method see each picture and its middle, as in a live session; handing it over "
                 "counts as solve")
      ->excludes(no_render);
  add_size(*command, options->size, "Picture of one view, px");
  add_count(*command, "--views", options->views, 1, 2, "1, or 2 eyes side by side");
  command->add_option("--json", options->json, "Also write the figures to this file")->check(output_file());
  command->callback([options] {
    options->fluid.temporal.model = load_model(options->ptpe);
    const auto result = run_frames(*options);
    print_table(result);
    if (!options->json.empty()) base::write_file_atomically(options->json, result.dump(2) + "\n");
  });
}

}  // namespace apps
