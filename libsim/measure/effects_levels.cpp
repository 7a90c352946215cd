#include "libsim/measure/effects_levels.hpp"

#include <algorithm>
#include <optional>

#include "libsim/methods/method.hpp"
#include "stats/base/error.hpp"
#include "stats/figures/bar_chart.hpp"

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
    throw base::Error("scene " + scene.name, "lists no effect that has a coarsest_level",
                      "give one with such an effect, such as data/scenes/sea_spray.toml");
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

}  // namespace measure
