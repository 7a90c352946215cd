#include "libstudy/stimulus/bakes/bake_order.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "libsim/scene/fill.hpp"
#include "libsim/scene/picture_effects_text.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

std::string degrees(double value) { return value > 0 ? fmt::format("{:.6g} deg", value) : "not known"; }

bool same(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); }

std::string words_of(const std::optional<sim::BakedTolerance>& tolerance) {
  if (!tolerance) return "tau not known";
  const auto& [rate, model, seed] = *tolerance;
  return fmt::format("tau of {:.6g}, {:.6g} frames/s with a = {:.6g}, b = {:.6g}, seed {}", rate.mean,
                     rate.sd, model.a, model.b, seed);
}

std::string words_of(const sim::BakedView& view) {
  if (view.gaze.empty()) return "gaze not known";
  return view.gaze == "scene" ? "gaze along the scene's keys" : "gaze on the middle of the picture";
}

/// Collects the properties in which a shown stimulus differs from the wanted stimulus, as text.
class Departures {
 public:
  void add(const std::string& what, const std::string& shown, const std::string& wanted) {
    if (shown == wanted) return;
    all_.push_back((what.empty() ? "" : what + " ") + shown + " instead of " + wanted);
  }
  std::vector<std::string> take() { return std::move(all_); }

 private:
  std::vector<std::string> all_;
};

bool adaptive(const sim::BakeHeader& header) {
  return sim::traits_of(sim::parse_method(header.method)).adaptive();
}

sim::BakedView view_of(const BakeOrder& order, const sim::Scene& scene, bool follows_gaze) {
  sim::BakedView view;
  view.gaze = "none";
  if (!order.pictures && !follows_gaze) return view;
  const sim::Camera& camera = order.fluid.overview ? scene.overview : scene.view;
  const Framing framing = frame_picture(camera, order.fluid.viewing, order.size.width, order.size.height);
  view.width_px = order.size.width;
  view.height_px = order.size.height;
  view.camera_angle_deg = framing.camera_deg;
  view.visual_angle_deg = framing.visual_deg;
  view.surface = order.fluid.surface;
  if (!follows_gaze) return view;
  const bool keys = order.scene_gaze && !scene.gaze.empty();
  view.gaze = keys ? "scene" : "middle";
  view.gaze_path = keys ? scene.gaze : std::vector<sim::GazeKey>{{0, camera.target_m}};
  return view;
}

/// Maximum number of the scene's foam particles; 0 without foam.
std::int64_t foam_of(const sim::Scene& scene) {
  const auto effects = sim::coefficients_of(scene.effects);
  if (effects[sim::EffectKind::Foam] == 0) return 0;
  return static_cast<std::int64_t>(effects.options[static_cast<std::size_t>(sim::EffectOption::FoamMost)]);
}

std::string effects_words(const sim::BakeHeader& header) {
  auto effects = sim::baked_scene(header).effects;
  std::sort(effects.begin(), effects.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  const std::string words = sim::effects_in_words(effects);
  return words.empty() ? "no effects" : words;
}

std::string picture_words(const sim::BakeHeader& header) {
  auto effects = sim::baked_scene(header).picture_effects;
  std::sort(effects.begin(), effects.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  const std::string words = sim::picture_effects_in_words(effects);
  return words.empty() ? "no effects of the picture" : words;
}

/// Adds a departure if the bake's pictures show another surface than wanted. Some bakes record no surface:
/// they show ellipsoids, or spheres if an older version made them. They are accepted if no surface is wanted.
void add_surface(Departures& out, const sim::BakeHeader& bake, const sim::BakedView& wanted) {
  const sim::BakedView& found = bake.view;
  if (!found.drawn() || !wanted.drawn()) return;
  const auto words = [](const std::string& surface, const char* none) {
    return surface.empty() ? none : surface;
  };
  if (wanted.surface.empty() && found.surface != "spheres") return;
  out.add(bake.has_pictures() ? "pictures of" : "particles of a method that followed pictures of",
          words(found.surface, "a surface that is not recorded"), words(wanted.surface, "ellipsoids"));
}

std::string overlay_words(const sim::BakeHeader& header) {
  return (header.overlay.empty() ? "nothing" : header.overlay) + " painted over them";
}

}  // namespace

sim::BakeHeader header_of(const BakeOrder& order) {
  sim::BakeHeader header;
  header.scene_text = sim::scene_text(order.fluid.scene);
  sim::Scene scene = sim::read_scene(order.fluid.scene);
  if (order.fluid.effects) scene.effects = *order.fluid.effects;
  if (order.fluid.picture_effects)
    header.picture_effects = sim::format_picture_effects(*order.fluid.picture_effects);
  if (sim::any_free(scene.obstacles) && !order.pictures)
    throw base::Error(order.fluid.scene.string(),
                      "has free obstacles, which a bake of particles does not store",
                      "bake pictures too, or keep the obstacles fixed");
  const sim::MethodTraits& traits = sim::traits_of(sim::parse_method(order.fluid.method));
  header.scene_name = scene.name;
  header.scene_sha256 = scene.sha256;
  header.method = traits.name;
  header.program_version = base::version();
  header.n_star = sim::parse_n_star(order.fluid.n_star);
  header.frame_count = order.frames;
  header.frame_dt_s = order.fluid.content_step_s > 0 ? order.fluid.content_step_s : scene.frame_dt_s;
  header.tank_size_m = scene.tank_size_m;
  header.effects = sim::format_effects(scene.effects);
  const sim::Scene acting = sim::acting_scene(scene, traits.kind);
  header.max_foam = foam_of(acting);
  if (sim::TemperatureScale(acting).heat()) header.reference_k = sim::reference_temperature(scene);
  if (order.fluid.paint_temperature) {
    if (!header.reference_k)
      throw base::Error(
          order.fluid.scene.string(), "has no heat, and so no temperatures to paint, with " + header.method,
          "list heat as an [[effect]] that acts with this method, or leave the overlay 'temperature' out");
    header.overlay = "temperature";
  }
  header.view = view_of(order, scene, traits.adaptive());
  if (order.pictures) {
    header.picture_width_px = order.size.width;
    header.picture_height_px = order.size.height;
    header.camera = order.fluid.overview ? "overview" : "view";
  }
  if (traits.temporal) {
    if (!order.fluid.fixed_rate)
      throw base::Error(header.method,
                        "chooses the particles to solve by tau, which depends on the frame rate",
                        "give the frame rate: --rate MEAN,SD in frames/s");
    header.tolerance = {*order.fluid.fixed_rate, order.fluid.model, sim::TemporalOptions{}.seed};
  }
  return header;
}

std::vector<std::string> fluid_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted) {
  Departures out;
  out.add("scene", found.scene_name + " " + found.scene_sha256.substr(0, 12),
          wanted.scene_name + " " + wanted.scene_sha256.substr(0, 12));
  out.add("method", found.method, wanted.method);
  out.add("n_*", std::to_string(found.n_star), std::to_string(wanted.n_star));
  if (found.scene_sha256 == wanted.scene_sha256) {
    out.add("", effects_words(found), effects_words(wanted));
    out.add("", picture_words(found), picture_words(wanted));
    const bool drawn = found.has_pictures();  // pictures show foam even if the bake stores no foam particles
    if (wanted.max_foam > 0 && found.max_foam == 0 && !drawn && effects_words(found) == effects_words(wanted))
      out.add("", "no particles of foam", "foam (bakes before format 4 kept none)");
    if (drawn)
      out.add("pictures with", overlay_words(found), overlay_words(wanted));
    else if (!wanted.overlay.empty() && !found.reference_k && effects_words(found) == effects_words(wanted))
      out.add("", "no temperatures", "temperatures to paint (bakes before format 5 kept none)");
  }
  add_surface(out, found, wanted.view);
  // The bake's file stores a rounded content step.
  if (std::abs(found.frame_dt_s - wanted.frame_dt_s) > 1e-3 * wanted.frame_dt_s)
    out.add("content step", fmt::format("{:.6g} s", found.frame_dt_s),
            fmt::format("{:.6g} s", wanted.frame_dt_s));
  if (found.frame_count < wanted.frame_count)
    out.add("", std::to_string(found.frame_count) + " frames", std::to_string(wanted.frame_count));
  if (found.method != wanted.method) return out.take();
  if (wanted.tolerance) {
    const auto &a = found.tolerance, &b = wanted.tolerance;
    if (!a || !same(a->rate.mean, b->rate.mean) || !same(a->rate.sd, b->rate.sd) ||
        !same(a->model.a, b->model.a) || !same(a->model.b, b->model.b) || a->seed != b->seed)
      out.add("", words_of(a), words_of(b));
  }
  if (adaptive(wanted)) out.add("", words_of(found.view), words_of(wanted.view));
  return out.take();
}

std::vector<std::string> view_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted) {
  Departures out;
  const sim::BakedView &a = found.view, &b = wanted.view;
  if (!a.drawn() || !b.drawn()) return {};
  const auto camera = [](const sim::BakeHeader& one) {
    return one.camera == "overview" ? "overview" : "view";
  };
  out.add("camera", camera(found), camera(wanted));
  out.add("picture", base::size_words({a.width_px, a.height_px}),
          base::size_words({b.width_px, b.height_px}));
  if (std::abs(a.camera_angle_deg - b.camera_angle_deg) > same_angle_deg)
    out.add("camera angle", degrees(a.camera_angle_deg), degrees(b.camera_angle_deg));
  const double seen_deg = a.visual_angle_deg.value_or(0), wanted_deg = b.visual_angle_deg.value_or(0);
  if (std::abs(seen_deg - wanted_deg) > same_angle_deg)
    out.add("angle of the eye's view", degrees(seen_deg), degrees(wanted_deg));
  return out.take();
}

}  // namespace study
