#include <fmt/core.h>
#include <cmath>

#include "libsim/scene/picture_effects_text.hpp"
#include "libsim/solver/settled_state.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

std::unique_ptr<Stimulus> from_bake(const StimulusChoice& choice) {
  auto bake = std::make_unique<sim::BakeReader>(choice.bake);
  const double dt = bake->header().frame_dt_s;
  if (choice.content_step_s > 0 && std::abs(choice.content_step_s - dt) > 1e-3 * dt) {
    throw base::Error(choice.bake.string(),
                      fmt::format("holds frames {:.6g} s apart, but the content step is {:.6g} s", dt,
                                  choice.content_step_s),
                      "bake with the protocol's content step, or change it there");
  }
  if (bake->header().has_pictures()) return std::make_unique<BakedPictures>(std::move(bake));
  return std::make_unique<BakedParticles>(std::move(bake), choice.viewing, sim::RenderOptions{},
                                          choice.paint_temperature);
}

/// The effects as text, if there are any or the choice overrides them.
std::string live_effects(const StimulusChoice& choice, const sim::Scene& scene) {
  const std::string water = sim::effects_in_words(scene.effects);
  const std::string picture = sim::picture_effects_in_words(scene.picture_effects);
  std::string out;
  if (choice.effects || !water.empty()) out += ", effects " + (water.empty() ? "none" : water);
  if (choice.picture_effects) out += ", of the picture " + (picture.empty() ? "none" : picture);
  return out;
}

}  // namespace

std::unique_ptr<LiveFluid> make_live_fluid(const StimulusChoice& choice,
                                           const std::function<void(int, int)>& settling) {
  sim::Scene scene = sim::read_scene(choice.scene);
  if (choice.overview) scene.view = scene.overview;
  if (choice.effects) scene.effects = *choice.effects;
  if (choice.picture_effects) scene.picture_effects = *choice.picture_effects;
  sim::SimulationOptions options;
  const auto backend = sim::choose_backend(choice.backend);
  if (choice.setting) {
    options = sim::to_options(*choice.setting, backend, 1);
  } else {
    options.method = sim::parse_method(choice.method);
    options.n_star = sim::parse_n_star(choice.n_star);
    options.backend = backend;
    options.temporal.fixed_rate = choice.fixed_rate;
    options.temporal.model = choice.model;
  }
  options.cache = sim::default_cache_folder();
  if (choice.content_step_s > 0) options.frame_dt_s = choice.content_step_s;
  options.settling = settling;
  const double dt = options.frame_dt_s > 0 ? options.frame_dt_s : scene.frame_dt_s;
  const std::string description = "live " + scene.name + ", " + sim::method_name(options.method) + ", n_* " +
                                  std::to_string(options.n_star) + ", on " +
                                  sim::backend_name(options.backend) + ", scene " + scene.sha256 +
                                  live_effects(choice, scene) +
                                  (choice.setting ? ", at " + sim::to_text(*choice.setting) : "");
  // Settled once; each rewind starts from that state.
  const auto make = [scene, options]() mutable {
    auto simulation = sim::make_simulation(scene, options);
    if (!options.start) options.start = simulation->read_state();
    return simulation;
  };
  return std::make_unique<LiveFluid>(scene, dt, description, make, choice.viewing, choice.render,
                                     choice.paint_temperature);
}

std::unique_ptr<Stimulus> make_stimulus(const StimulusChoice& choice) {
  if (choice.bake.empty()) return make_live_fluid(choice);
  return from_bake(choice);
}

bool shows_pictures(const StimulusChoice& choice) {
  return !choice.bake.empty() && sim::BakeReader(choice.bake).header().has_pictures();
}

}  // namespace study
