#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/view/effect_switches.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/setting/setting_file.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

sim::SimulationOptions chosen(const ViewOptions& options) {
  sim::SimulationOptions out;
  out.method = sim::parse_method(options.method);
  out.n_star = sim::parse_n_star(options.n_star);
  out.backend = sim::choose_backend(options.backend);
  out.readings = sim::readings_of(sim::parse_preset(options.preset));
  out.levels = options.levels;
  out.temporal.fixed_tau = sim::parse_tau(options.tau);
  return out;
}

/// True if method, n_star and levels still have the values of the setting file and the preset is "tuned".
bool as_set(const ViewOptions& options) {
  if (!options.setting) return false;
  const sim::SolverSetting& of = options.setting->setting;
  return sim::parse_method(options.method) == of.method && options.preset == "tuned" &&
         sim::parse_n_star(options.n_star) == std::llround(of[sim::SolverKnob::Size]) &&
         options.levels == static_cast<int>(of[sim::SolverKnob::Levels]);
}

/// True if alpha and iterations, which the panel changes in a running fluid, are those of the setting file.
bool numbers_as_set(const ViewOptions& options) {
  const sim::SolverSetting& of = options.setting->setting;
  return (!options.alpha || *options.alpha == of[sim::SolverKnob::Alpha]) &&
         options.iterations == static_cast<int>(of[sim::SolverKnob::Iterations]);
}

}  // namespace

void take_setting(ViewOptions& options, const std::string& path) {
  options.setting = sim::read_setting_file(path);
  const sim::SolverSetting& of = options.setting->setting;
  const auto made = sim::to_options(of, sim::Backend::Cpu, 1);
  options.method = sim::method_name(of.method);
  options.n_star = std::to_string(made.n_star);
  options.levels = static_cast<int>(of[sim::SolverKnob::Levels]);
  if (sim::turns(sim::SolverKnob::Alpha, of.method)) options.alpha = of[sim::SolverKnob::Alpha];
  options.iterations = made.iterations;
  options.tau = made.temporal.fixed_tau ? "fixed:" + base::shortest(*made.temporal.fixed_tau) : "live";
}

std::vector<std::string> price_lines(const ViewOptions& options, const sim::SolverSetting& setting,
                                     const sim::Scene& scene) {
  if (!options.sweep) return {};
  if (sim::parse_preset(options.preset) != sim::Preset::Tuned)
    return {"not measured: sweeps run the tuned readings, not the paper's"};
  return study::in_words(study::prices_of(*options.sweep, setting, scene.sha256));
}

sim::Scene drawn(const PreparedFluid& prepared) {
  return sim::acting_scene(prepared.scene, prepared.setting.method);
}

sim::RenderOptions render_options(const ViewOptions& options) {
  sim::RenderOptions out;
  out.surface = sim::parse_surface(options.surface);
  return out;
}

PreparedFluid prepare_fluid(const ViewOptions& options, const std::function<void(int, int)>& settling) {
  PreparedFluid prepared;
  prepared.scene = sim::read_scene(base::find_input(options.scene));
  prepared.listed = prepared.scene.effects;
  prepared.scene.effects = options.effects ? *options.effects : left_on(prepared.listed, options.effects_off);
  prepared.camera = options.camera == "overview" ? prepared.scene.overview : prepared.scene.view;
  if (!options.ptpe.empty()) prepared.ptpe = sim::read_ptpe_file(options.ptpe);
  sim::SimulationOptions choice =
      as_set(options) ? sim::to_options(options.setting->setting, sim::choose_backend(options.backend), 1)
                      : chosen(options);
  if (options.alpha) choice.readings.alpha = *options.alpha;
  if (options.iterations) choice.iterations = *options.iterations;
  choice.cache = sim::default_cache_folder();
  // In a window the user may choose an overlay of saliency later.
  choice.saliency_parts = options.overlay != "none" || options.display == "window";
  if (prepared.ptpe) choice.temporal.model = prepared.ptpe->model;
  prepared.frame_dt_s = choice.frame_dt_s > 0 ? choice.frame_dt_s : prepared.scene.frame_dt_s;
  prepared.setting = sim::setting_of(prepared.scene, choice);
  prepared.finest_spacing_m =
      sim::resolution_of(prepared.scene, choice.method, choice.n_star).finest_spacing_m;
  prepared.follows_rate =
      (choice.temporal.always || sim::traits_of(choice.method).temporal) && !choice.temporal.fixed_tau;
  {
    base::Progress progress("settling", static_cast<std::size_t>(std::max(1, prepared.scene.settle_frames)));
    choice.settling =
        settling ? settling : [&](int done, int) { progress.update(static_cast<std::size_t>(done)); };
    prepared.fluid = sim::make_simulation(prepared.scene, choice);
  }
  prepared.follows_picture = prepared.fluid->follows_picture();
  std::printf("%s, %s, n_* %lld: %lld particles on %s\n", prepared.scene.name.c_str(),
              sim::method_name(choice.method).c_str(), static_cast<long long>(choice.n_star),
              static_cast<long long>(prepared.fluid->particle_count()),
              sim::backend_name(choice.backend).c_str());
  if (!options.effects_off.empty()) std::printf("with %s\n", in_words(prepared.scene.effects).c_str());
  if (as_set(options) && numbers_as_set(options)) {
    std::printf("%s\n", sim::describe(*options.setting).c_str());
    const auto note = sim::other_scene(*options.setting, prepared.scene.sha256);
    if (!note.empty()) std::printf("%s\n", note.c_str());
  }
  for (const auto& line : price_lines(options, prepared.setting, prepared.scene))
    std::printf("sweep  %s\n", line.c_str());
  if (options.explain) {
    std::printf("%s%s\n", prepared.fluid->explain().c_str(), sim::passes_in_words(drawn(prepared)).c_str());
  }
  return prepared;
}

}  // namespace apps
