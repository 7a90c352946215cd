#include "libsim/measure/effects_cost.hpp"

#include <algorithm>

#include "stats/base/error.hpp"
#include "stats/figures/bar_chart.hpp"

namespace measure {

namespace {

sim::Scene with(sim::Scene scene, std::vector<sim::Effect> effects) {
  scene.effects = std::move(effects);
  return scene;
}

const sim::Effect* find(const std::vector<sim::Effect>& effects, sim::EffectKind kind) {
  for (const sim::Effect& effect : effects)
    if (effect.kind == kind) return &effect;
  return nullptr;
}

std::string name_of(const std::vector<sim::Effect>& effects) {
  std::string out;
  for (const sim::Effect& effect : effects)
    out += (out.empty() ? "" : " + ") + std::string(sim::traits_of(effect.kind).word);
  return out;
}

}  // namespace

std::vector<sim::Effect> with_needs(const std::vector<sim::Effect>& all, const sim::Effect& effect) {
  std::vector<sim::Effect> out{effect};
  for (auto needs = sim::traits_of(effect.kind).needs; needs != sim::no_effect;
       needs = sim::traits_of(needs).needs) {
    // The scene's reader ensures that a scene lists each needed effect.
    if (const sim::Effect* other = find(all, needs)) out.insert(out.begin(), *other);
  }
  return out;
}

std::vector<EffectVariant> variants_of(const sim::Scene& scene) {
  std::vector<sim::Effect> all, at_zero;
  for (sim::Effect effect : scene.effects) {
    if (effect.coefficient == 0) continue;
    all.push_back(effect);
    effect.coefficient = 0;
    at_zero.push_back(effect);
  }
  if (all.empty())
    throw base::Error("scene " + scene.name, "lists no effect with a coefficient above 0",
                      "give a scene with such an effect, for example data/scenes/splash.toml; the cost of "
                      "picture effects is measured by vip-bench frame");
  std::vector<EffectVariant> out{{"none", with(scene, {})}};
  for (const sim::Effect& effect : all) {
    auto effects = with_needs(all, effect);
    out.push_back({name_of(effects), with(scene, std::move(effects))});
  }
  const auto holds_all = [&](const EffectVariant& variant) {
    return variant.scene.effects.size() == all.size();
  };
  if (std::none_of(out.begin(), out.end(), holds_all)) out.push_back({"all", with(scene, all)});
  out.push_back({"all at 0", with(scene, at_zero)});
  return out;
}

figures::TextTable to_table(const EffectsRun& run, const std::vector<EffectCost>& costs) {
  figures::TextTable out{
      {"scene", "method", "backend", "n_star", "frames", "substeps", "effects", "particles_mean",
       "ms_frame_mean", "ms_added", "added_percent", "launches_a_frame", "launches_added", "column_bytes",
       "column_bytes_added", "device_bytes", "device_bytes_added", "same_state"},
      {}};
  const EffectCost& bare = costs.front();
  for (const EffectCost& cost : costs) {
    const double added = cost.ms_frame - bare.ms_frame;
    out.rows.push_back(
        {run.scene, run.method, run.backend, run.n_star, std::to_string(run.frames),
         std::to_string(run.substeps), cost.name, figures::number(cost.particles, 0),
         figures::number(cost.ms_frame, 4), figures::number(added, 4),
         figures::number(100 * added / bare.ms_frame, 1), figures::number(cost.launches, 1),
         figures::number(cost.launches - bare.launches, 1), figures::number(cost.column_bytes, 0),
         figures::number(cost.column_bytes - bare.column_bytes, 0), figures::number(cost.device_bytes, 0),
         figures::number(cost.device_bytes - bare.device_bytes, 0), cost.same_state ? "yes" : "no"});
  }
  return out;
}

std::string to_svg(const EffectsRun& run, const std::vector<EffectCost>& costs) {
  figures::BarChart chart;
  chart.title = run.scene + ", " + run.method + " on " + run.backend + ", n_* " + run.n_star;
  chart.unit = "ms a frame";
  chart.digits = 3;
  for (const EffectCost& cost : costs) chart.bars.push_back({"effects", cost.name, cost.ms_frame});
  return figures::to_svg(chart);
}

}  // namespace measure
