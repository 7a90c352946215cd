#include "libsim/measure/effects_levels.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "libsim/gl/gl_context.hpp"
#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/error.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/timing.hpp"
#include "stats/figures/bar_chart.hpp"
#include "stats/image/flip.hpp"
#include "stats/image/psnr.hpp"
#include "stats/image/ssim.hpp"

namespace measure {

namespace {

std::string words_of(int coarsest) { return coarsest == 0 ? "0" : "0 to " + std::to_string(coarsest); }

}  // namespace

std::vector<LevelVariant> level_variants_of(const sim::Scene& scene) {
  std::vector<LevelVariant> out;
  for (const sim::Effect& effect : scene.effects) {
    const auto option = sim::coarsest_level_of(effect.kind);
    if (!option || sim::traits_of(*option).of != effect.kind || effect.coefficient == 0) continue;
    const auto add = [&](const std::string& levels, std::optional<int> coarsest, bool moved) {
      sim::Scene with = scene;
      with.effects = with_needs(scene.effects, effect);
      if (coarsest) with.effects.back().options[static_cast<std::size_t>(*option)] = *coarsest;
      if (!coarsest) with.effects.pop_back();
      out.push_back({sim::traits_of(effect.kind).word, levels, effect.kind, std::move(with), moved});
    };
    constexpr int all = sim::most_levels - 1;
    add("none", {}, false);
    for (int coarsest = all; coarsest >= 0; --coarsest) add(words_of(coarsest), coarsest, false);
    add(words_of(all) + ", start moved", all, true);
  }
  if (out.empty())
    throw base::Error("scene " + scene.name,
                      "lists no effect that has a coarsest_level and a coefficient above 0",
                      "give a scene with such an effect, for example data/scenes/sea_spray.toml");
  return out;
}

figures::TextTable to_table(const EffectsRun& run, const std::vector<LevelCost>& costs) {
  figures::TextTable out{
      {"scene", "method", "backend", "n_star", "frames", "substeps", "effect", "levels", "particles_mean",
       "ms_frame_median", "ms_added", "ms_passes", "saved_percent", "psnr_db", "ssim", "flip_percent"},
      {}};
  for (const LevelCost& cost : costs) {
    const auto first = std::find_if(costs.begin(), costs.end(),
                                    [&](const LevelCost& other) { return other.effect == cost.effect; });
    const double all = std::next(first)->ms_passes;
    out.rows.push_back(
        {run.scene, run.method, run.backend, run.n_star, std::to_string(run.frames),
         std::to_string(run.substeps), cost.effect, figures::in_a_cell(cost.levels),
         figures::number(cost.particles, 0), figures::number(cost.ms_frame, 4),
         figures::number(cost.ms_frame - first->ms_frame, 4), figures::number(cost.ms_passes, 4),
         figures::number(100 * (1 - cost.ms_passes / all), 1), figures::number(cost.psnr_db, 2),
         figures::number(cost.ssim, 4), figures::number(cost.flip_percent, 2)});
  }
  return out;
}

std::string to_svg(const EffectsRun& run, const std::vector<LevelCost>& costs) {
  figures::BarChart chart;
  chart.title = run.scene + ", " + run.method + " on " + run.backend + ", n_* " + run.n_star +
                ": passes of an effect at some levels";
  chart.unit = "ms";
  chart.digits = 3;
  for (const LevelCost& cost : costs) {
    if (cost.levels == "none") continue;
    const auto comma = cost.levels.find(", ");
    const std::string label =
        comma == std::string::npos ? "level " + cost.levels : cost.levels.substr(comma + 2);
    chart.bars.push_back({cost.effect, label, cost.ms_passes});
  }
  return figures::to_svg(chart);
}

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

/// Runs one frame. `counts`: true if the frame's numbers enter the means and medians; `keep`: true if its
/// picture is stored.
void step(Running& running, const sim::Scene& scene, const LevelRuns& runs, bool counts, bool keep) {
  sim::Simulation& fluid = *running.fluid;
  const double dt_s = runs.choice.frame_dt_s > 0 ? runs.choice.frame_dt_s : scene.frame_dt_s;
  const sim::Vec3d at = sim::gaze_point(scene, sim::scene_frame(scene, fluid.frame() + 1, dt_s));
  running.eye->look(fluid, at);
  const double begin = base::milliseconds_now();
  fluid.step_frame();
  fluid.synchronize();
  const double ms = base::milliseconds_now() - begin;
  fluid.frame_time(ms);
  if (keep || fluid.needs_every_picture()) running.eye->draw(fluid);
  if (keep) running.pictures.push_back(running.eye->picture());
  if (!counts) return;
  running.cost.particles += static_cast<double>(fluid.particle_count()) / runs.frames;
  running.ms_frame.push_back(ms);
  running.ms_passes.push_back(0);
  for (const auto& pass : fluid.passes())
    if (pass.effect == running.kind) running.ms_passes.back() += pass.ms;
}

/// Sets the picture differences of `running` from `reference`, the run with the effect at all levels.
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
    throw base::Error("--levels",
                      "compares levels, and method " + sim::method_name(runs.choice.method) + " has only one",
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
    const std::string place = scene.name + ", " + running.cost.effect + " at " + running.cost.levels;
    sim::check_finite(*running.fluid, place);
    sim::print_guards(place, *running.fluid);
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
