#include "libsim/measure/effects_levels_run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/error.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/timing.hpp"
#include "stats/image/flip.hpp"
#include "stats/image/psnr.hpp"
#include "stats/image/ssim.hpp"

namespace measure {

namespace {

constexpr int instants = 4;

struct Running {
  LevelCost cost;
  sim::EffectKind kind;
  std::unique_ptr<Onlooker> eye;
  std::unique_ptr<sim::Simulation> fluid;
  std::vector<sim::Picture> pictures;
  std::vector<double> ms_frame = {}, ms_passes = {};
};

Running start(const LevelVariant& variant, const std::vector<sim::ParticleState>& water,
              const LevelRuns& runs) {
  sim::SimulationOptions options = runs.choice;
  options.start = perturbed(water, variant.moved ? 1 : 0);
  Running out{.cost = {.effect = variant.effect, .levels = variant.levels},
              .kind = variant.kind,
              .eye = std::make_unique<Onlooker>(variant.scene, runs.size),
              .fluid = sim::make_simulation(variant.scene, options),
              .pictures = {}};
  out.fluid->time_passes(true);
  return out;
}

/// Runs one frame. counts: adds it to the means; keep: stores its picture.
void step(Running& running, const sim::Scene& scene, const LevelRuns& runs, bool counts, bool keep) {
  sim::Simulation& fluid = *running.fluid;
  const double dt_s = runs.choice.frame_dt_s > 0 ? runs.choice.frame_dt_s : scene.frame_dt_s;
  const sim::Vec3d at = sim::gaze_point(scene, sim::scene_frame(scene, fluid.frame() + 1, dt_s));
  running.eye->look(fluid, runs.choice.method, at);
  const double begin = base::milliseconds_now();
  fluid.step_frame();
  fluid.synchronize();
  const double ms = base::milliseconds_now() - begin;
  fluid.frame_time(ms);
  if (keep || fluid.follows_picture()) running.eye->draw(fluid);
  if (keep) running.pictures.push_back(running.eye->picture());
  if (!counts) return;
  running.cost.particles += static_cast<double>(fluid.particle_count()) / runs.frames;
  running.ms_frame.push_back(ms);
  running.ms_passes.push_back(0);
  for (const auto& pass : fluid.passes())
    if (pass.effect == running.kind) running.ms_passes.back() += pass.ms;
}

/// Compares with the pictures of the effect at all levels.
void compare(Running& running, const Running& reference) {
  const double pixels_per_degree = std::numbers::pi / 180 / sim::pixel_rays(running.eye->view()).scale_y;
  const double count = static_cast<double>(running.pictures.size());
  double square = 0;
  for (std::size_t i = 0; i < running.pictures.size(); ++i) {
    const auto now = running.pictures[i].view(), then = reference.pictures[i].view();
    square += stats::mean_squared_error(now, then).value / count;
    running.cost.ssim += stats::ssim_map(now, then).mean().value / count;
    running.cost.flip_percent += 100 * stats::flip(now, then, pixels_per_degree).value / count;
  }
  running.cost.psnr_db = 10 * std::log10(255 * 255 / square);
}

}  // namespace

std::vector<LevelCost> run_levels(const std::vector<LevelVariant>& variants, const LevelRuns& runs) {
  if (!sim::traits_of(runs.choice.method).adaptive())
    throw base::Error("--levels", "compares levels, and " + sim::method_name(runs.choice.method) + " has one",
                      "choose a method that splits and merges, such as --method Ours");
  const auto context = sim::GlContext::make_headless();
  const sim::Scene& scene = variants.front().scene;
  const auto water = make_settled(scene, runs.choice)->read_state();
  std::vector<Running> all;
  for (const LevelVariant& variant : variants) all.push_back(start(variant, water, runs));
  base::Progress progress("frames", static_cast<std::size_t>(runs.warm_up + runs.frames));
  for (int frame = 1; frame <= runs.warm_up + runs.frames; ++frame) {
    const int timed = frame - runs.warm_up;
    const bool keep = timed > 0 && timed * instants / runs.frames > (timed - 1) * instants / runs.frames;
    for (Running& running : all) step(running, scene, runs, timed > 0, keep);
    progress.update(static_cast<std::size_t>(frame));
  }
  std::vector<LevelCost> out;
  for (Running& running : all) {
    sim::check_finite(*running.fluid, scene.name + ", " + running.cost.effect + " at " + running.cost.levels);
    const auto first = std::find_if(all.begin(), all.end(), [&](const Running& other) {
      return other.cost.effect == running.cost.effect;
    });
    compare(running, *std::next(first));
    running.cost.ms_frame = base::quantile(running.ms_frame, 0.5);
    running.cost.ms_passes = base::quantile(running.ms_passes, 0.5);
    out.push_back(running.cost);
  }
  return out;
}

}  // namespace measure
