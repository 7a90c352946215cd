#include <omp.h>

#include <memory>
#include <numeric>
#include <optional>

#include "apps/bench/frame.hpp"
#include "libsim/exec/bandwidth.hpp"
#include "libsim/measure/cells.hpp"
#include "libsim/measure/launch_table.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/particles/divergence.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/simulation.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/timing.hpp"

namespace apps {

namespace {

/// The account of a frame as JSON, with the names of the database's columns. frame: number of frames since
/// the settled start state. Values that were not measured are null; without guard counts, the key "guards" is
/// missing.
base::Json account_json(std::int64_t frame, const study::FrameFacts& facts) {
  base::Json out{{"frame", frame}, {"particles", facts.particles_by_level}};
  const auto t = facts.tolerance.value_or(study::FrameTolerance{});
  const bool known = facts.tolerance.has_value();
  out["active_fraction"] = known ? base::Json(t.active_fraction) : base::Json();
  out["tau_fps"] = t.tau_fps;
  out["beta"] = known ? base::Json(t.beta) : base::Json();
  out["mu_fps"] = t.mu_fps;
  out["delta_fps"] = t.delta_fps;
  if (const auto& met = facts.guards) {
    out["guards"] = {{"speed_limited", met->speed_limited},
                     {"coincident_pairs", met->coincident_pairs},
                     {"not_finite", met->not_finite},
                     {"neighbours_dropped", met->neighbours_dropped},
                     {"wall_projected", met->wall_projected},
                     {"nozzle_waited", met->nozzle_waited},
                     {"saliency_not_finite", met->saliency_not_finite},
                     {"gaze_lost", met->gaze_lost}};
  }
  return out;
}

base::Json divergence_json(const std::optional<sim::Divergence>& divergence) {
  if (!divergence) return {};
  base::Json out{{"frame", divergence->frame},
                 {"particle", divergence->particle},
                 {"cause", sim::in_words(divergence->cause)},
                 {"count", divergence->count},
                 {"in_words", sim::in_words(*divergence)}};
  if (const auto& at = divergence->where_m) out["where_m"] = *at;
  return out;
}

std::unique_ptr<sim::Simulation> make_fluid(const sim::Scene& scene, const FrameOptions& options) {
  sim::SimulationOptions out = options.fluid;
  out.method = sim::parse_method(options.method);
  out.n_star = sim::parse_n_star(options.n_star);
  out.backend = sim::choose_backend(options.backend);
  out.temporal.fixed_tau = sim::parse_tau(options.tau);
  if (!options.rate.empty()) out.temporal.fixed_rate = sim::parse_frame_rate(options.rate);
  return measure::make_settled(scene, std::move(out));
}

/// Ratio of the kernel's support radius h (four times the first particle's radius) to the rest spacing d.
double h_over_d(const sim::Simulation& fluid) {
  std::vector<sim::RenderParticle> particles;
  fluid.read_particles(particles);
  return particles.empty() ? 0 : 4 * static_cast<double>(particles.front().radius_m) / fluid.spacing_m();
}

/// Times the drawing of pictures. If no pictures are drawn, `timer` is null and `left_out` is the reason.
struct Pictures {
  std::unique_ptr<measure::RenderTimer> timer;
  std::string left_out;
};

Pictures make_pictures(const sim::Scene& scene, const FrameOptions& options) {
  const base::PictureSize size = options.size;
  if (options.no_render) return {nullptr, "--no-render"};
  std::optional<sim::GlContext> context;
  try {
    context.emplace(sim::GlContext::make_headless());
  } catch (const base::Error& error) {
    if (options.look) throw;
    return {nullptr, error.what()};
  }
  return {std::make_unique<measure::RenderTimer>(std::move(*context),
                                                 sim::acting_scene(scene, sim::parse_method(options.method)),
                                                 size, options.views, sim::parse_surface(options.surface)),
          ""};
}

/// The accounts of all frames. solved: mean fraction of particles that are solved; particles: mean number of
/// particles.
struct Accounts {
  base::Json all = base::Json::array();
  double solved = 0, particles = 0;
  void add(const sim::Simulation& fluid, double frame_dt_s) {
    const auto facts = study::to_facts(fluid.frame() * frame_dt_s, fluid.account());
    all.push_back(account_json(fluid.frame(), facts));
    const double share = facts.tolerance ? facts.tolerance->active_fraction : 1;
    const auto frames = static_cast<double>(all.size());
    solved += (share - solved) / frames;
    particles += (static_cast<double>(fluid.particle_count()) - particles) / frames;
  }
};

/// Adds the current state to `accuracy`. The kernel launches of this measurement are not added to `launches`.
void measure_apart(sim::Simulation& fluid, measure::Accuracy& accuracy, measure::LaunchSums* launches) {
  if (launches) {
    launches->add(fluid.launch_times());
    fluid.profile_launches(false);
  }
  accuracy.add(fluid.report());
  if (launches) fluid.profile_launches(true);
}

/// Kernel launches by pass and memory bandwidth for the JSON result; empty without --passes.
struct Passes {
  base::Json launches = base::Json::array();
  base::Json bandwidth_gb_s;
};
Passes passes_of(sim::Simulation& fluid, const FrameOptions& options, measure::LaunchSums& launches,
                 const measure::PassWater& water) {
  if (!options.passes) return {};
  launches.add(fluid.launch_times());
  fluid.profile_launches(false);
  // Measured after the frames, because the copies of this measurement change the caches.
  const double gb_s = sim::copy_bandwidth_gb_s(sim::choose_backend(options.backend));
  return {measure::launches_json(launches.all(), options.frames, water, gb_s), gb_s};
}

}  // namespace

base::Json run_frames(const FrameOptions& options) {
  const sim::Scene scene = sim::read_scene(base::find_input(options.scene));
  const Pictures pictures = make_pictures(scene, options);
  const auto fluid = make_fluid(scene, options);
  for (int frame = 0; frame < options.warm_up; ++frame) fluid->step_frame();
  fluid->synchronize();
  if (pictures.timer) pictures.timer->warm_up(*fluid);

  fluid->profile_launches(options.passes);
  std::vector<double> solve_ms, frame_ms;
  measure::Accuracy accuracy;
  Accounts accounts;
  measure::LaunchSums launches;
  base::Progress progress("frames", static_cast<std::size_t>(options.frames));
  const int stride =
      options.measure_every > 0
          ? options.measure_every
          : measure::tenth_of(options.frames, sim::parse_method(options.method), options.fluid.readings);
  measure::Substeps substeps;
  for (int frame = 0; frame < options.frames; ++frame) {
    const double start = base::milliseconds_now();
    if (options.look) pictures.timer->look(*fluid);
    fluid->step_frame();
    fluid->synchronize();
    solve_ms.push_back(base::milliseconds_now() - start);
    substeps.add(fluid->substeps());
    if (pictures.timer) {
      const auto times = pictures.timer->draw(*fluid);
      frame_ms.push_back(solve_ms.back() + times.transfer + times.render);
    }
    fluid->frame_time(pictures.timer ? frame_ms.back() : solve_ms.back());
    accounts.add(*fluid, options.fluid.frame_dt_s > 0 ? options.fluid.frame_dt_s : scene.frame_dt_s);
    if (frame % stride == stride - 1) measure_apart(*fluid, accuracy, options.passes ? &launches : nullptr);
    progress.update(static_cast<std::size_t>(frame) + 1);
  }
  const Passes passes =
      passes_of(*fluid, options, launches, {accounts.particles, accounts.solved, accuracy.listed_mean});
  sim::check_finite(*fluid, options.scene);
  if (!options.save_state.empty()) fluid->save_state(options.save_state);
  const auto report = fluid->report();
  const double mean =
      std::accumulate(solve_ms.begin(), solve_ms.end(), 0.0) / static_cast<double>(solve_ms.size());
  base::Json result{
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
      {"solve_ms_median", base::quantile(solve_ms, 0.5)},
      {"solve_ms_p95", base::quantile(solve_ms, 0.95)},
      {"solve_ms_p99", base::quantile(solve_ms, 0.99)},
      {"h_over_d", h_over_d(*fluid)},
      {"neighbours_mean", accuracy.neighbours_mean},
      {"listed_mean", accuracy.listed_mean},
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
        {"tau_fps", report.temporal.tau},
        {"beta", report.temporal.beta},
        {"solved_share_mean", accounts.solved}}},
      {"guards",
       {{"speed_limited", report.guards.speed_limited},
        {"coincident_pairs", report.guards.coincident_pairs},
        {"not_finite", report.guards.not_finite},
        {"neighbours_dropped", report.guards.neighbours_dropped},
        {"wall_projected", report.guards.wall_projected},
        {"nozzle_waited", report.guards.nozzle_waited}}},
      {"effects", measure::effect_books(sim::acting_scene(scene, sim::parse_method(options.method)), report)},
      {"divergence", divergence_json(fluid->divergence())},
      {"accounts", accounts.all},
      {"launches", passes.launches},
      {"bandwidth_gb_s", passes.bandwidth_gb_s},
      {"schedule", fluid->explain()}};
  if (pictures.timer) {
    result.update(pictures.timer->figures());
    result["frame_ms_median"] = base::quantile(frame_ms, 0.5);
    result["frame_ms_p95"] = base::quantile(frame_ms, 0.95);
    result["frame_ms_p99"] = base::quantile(frame_ms, 0.99);
  } else {
    result["render_left_out"] = pictures.left_out;
  }
  return result;
}

}  // namespace apps
