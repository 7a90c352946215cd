#include "libstudy/stimulus/fluid_stimulus.hpp"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libsim/scene/fill.hpp"
#include "libsim/scene/picture_effects_text.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/solver/settled_state.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

std::string or_none(const std::string& words) { return words.empty() ? "none" : words; }

/// The effects as text, if the bake's header has them.
std::string baked_effects(const sim::BakeHeader& header) {
  if (!header.effects && !header.picture_effects) return "";
  const sim::Scene scene = sim::baked_scene(header);
  std::string out;
  if (header.effects) out += ", effects " + or_none(sim::effects_in_words(scene.effects));
  if (header.picture_effects)
    out += ", of the picture " + or_none(sim::picture_effects_in_words(scene.picture_effects));
  return out;
}

std::string describe(const sim::BakeReader& bake, const char* what) {
  const sim::BakeHeader& h = bake.header();
  return std::string(what) + " of " + h.scene_name + ", " + h.method + ", n_* " + std::to_string(h.n_star) +
         ", computed on " + h.backend + ", bake " + bake.content_hash() + ", scene " + h.scene_sha256 +
         baked_effects(h);
}

/// The temperature scale if `paint` is true and the scene has heat; otherwise none.
std::optional<sim::TemperatureScale> painted(const sim::Scene& scene, bool paint) {
  const sim::TemperatureScale scale(scene);
  if (!paint || !scale.heat()) return {};
  return scale;
}

std::string painted_words(const std::optional<sim::TemperatureScale>& scale) {
  return scale ? ", painted " + scale->words() : "";
}

/// The choice's options of the renderer, with its surface.
sim::RenderOptions render_options(const StimulusChoice& choice) {
  sim::RenderOptions out = choice.render;
  if (!choice.surface.empty()) out.surface = sim::parse_surface(choice.surface);
  return out;
}

/// Names the surface unless it is the usual one.
std::string surface_words(sim::Surface surface) {
  return surface == sim::RenderOptions{}.surface ? ""
                                                 : std::string(", drawn as ") + sim::surface_name(surface);
}

/// Point at which the forward axis of an eye meets its picture, px from the lower left. This is not the
/// middle of the picture, because a headset's frusta are off-centre.
std::pair<double, double> straight_ahead(const sim::View& view) {
  const sim::PixelRays rays = sim::pixel_rays(view);
  return {static_cast<double>(-rays.offset_x / rays.scale_x),
          static_cast<double>(-rays.offset_y / rays.scale_y)};
}

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
  return std::make_unique<BakedParticles>(std::move(bake), choice.viewing, render_options(choice),
                                          choice.paint_temperature);
}

/// The effects as text, if the scene has any or `choice` overrides them.
std::string live_effects(const StimulusChoice& choice, const sim::Scene& scene) {
  const std::string water = sim::effects_in_words(scene.effects);
  const std::string picture = sim::picture_effects_in_words(scene.picture_effects);
  std::string out;
  if (choice.effects || !water.empty()) out += ", effects " + (water.empty() ? "none" : water);
  if (choice.picture_effects) out += ", of the picture " + (picture.empty() ? "none" : picture);
  return out;
}

}  // namespace

FrameFacts to_facts(double simulation_time_s, const sim::FrameAccount& account) {
  FrameFacts out;
  out.simulation_time_s = simulation_time_s;
  out.particles_by_level = account.particles_by_level;
  if (const auto& went_by = account.temporal) {
    const auto particles = static_cast<double>(std::max<std::int64_t>(1, account.particles()));
    FrameTolerance& to = out.tolerance.emplace();
    to.tau_fps = went_by->tau;
    to.beta = went_by->beta;
    to.active_fraction = static_cast<double>(went_by->active) / particles;
    if (went_by->rate) {
      to.mu_fps = went_by->rate->mean;
      to.delta_fps = went_by->rate->sd;
    }
  }
  if (const auto& met = account.guards) {
    const auto count = [](std::uint64_t times) { return static_cast<std::int64_t>(times); };
    out.guards = {count(met->speed_limited),       count(met->coincident_pairs), count(met->not_finite),
                  count(met->neighbours_dropped),  count(met->wall_projected),   count(met->nozzle_waited),
                  count(met->saliency_not_finite), count(met->gaze_lost)};
  }
  return out;
}

BakedPictures::BakedPictures(std::unique_ptr<sim::BakeReader> bake) : bake_(std::move(bake)), ring_(*bake_) {}

BakedPictures::~BakedPictures() {
  if (!texture_) return;
  glDeleteFramebuffers(1, &source_);
  glDeleteTextures(1, &texture_);
}

std::string BakedPictures::description() const {
  const sim::BakeHeader& h = bake_->header();
  return describe(*bake_, "pictures") +
         (h.view.surface.empty() ? "" : surface_words(sim::parse_surface(h.view.surface))) + ", " +
         std::to_string(h.picture_width_px) + "x" + std::to_string(h.picture_height_px) + " from " +
         h.camera + (h.overlay.empty() ? "" : painted_words(painted(sim::baked_scene(h), true)));
}

void BakedPictures::start(std::int64_t start_step) {
  picture_ = nullptr;
  ring_.start(start_step);
}

FrameFacts BakedPictures::prepare(std::int64_t step) {
  picture_ = nullptr;
  picture_ = &ring_.take(step);
  return to_facts(picture_->facts.time_s, picture_->facts.account);
}

void BakedPictures::draw(const Canvas& canvas) {
  if (!canvas.eyes.empty()) {
    throw base::Error(description(), "is one picture, which would look flat in a headset",
                      "show a bake of particles in a headset");
  }
  if (!picture_)
    throw std::logic_error("BakedPictures::draw(): no picture is prepared; call prepare() first");
  const int width = bake_->header().picture_width_px, height = bake_->header().picture_height_px;
  if (!texture_) {
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, 1, GL_RGBA8, width, height);
    glCreateFramebuffers(1, &source_);
    glNamedFramebufferTexture(source_, GL_COLOR_ATTACHMENT0, texture_, 0);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(texture_, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, picture_->rgba.data());
  const Rectangle to = fit_picture(width, height, canvas.width_px, canvas.height_px);
  if (to.x0 > 0 || to.y0 > 0) {
    const float black[4] = {0, 0, 0, 1};
    glClearNamedFramebufferfv(canvas.framebuffer, GL_COLOR, 0, black);
  }
  const bool same = to.x1 - to.x0 == width && to.y1 - to.y0 == height;
  glBlitNamedFramebuffer(source_, canvas.framebuffer, 0, 0, width, height, to.x0, to.y0, to.x1, to.y1,
                         GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
}

BakedParticles::BakedParticles(std::unique_ptr<sim::BakeReader> bake, Viewing viewing,
                               const sim::RenderOptions& options, bool paint_temperature)
    : bake_(std::move(bake)),
      scene_(sim::acting_scene(sim::baked_scene(bake_->header()), sim::parse_method(bake_->header().method))),
      viewing_(std::move(viewing)),
      options_(options),
      surface_(scene_),
      painted_(painted(scene_, paint_temperature && bake_->header().reference_k)) {
  if (sim::any_free(scene_.obstacles))
    throw base::Error(description(),
                      "is a bake of particles, which does not store the free obstacles of its scene",
                      "show a bake of pictures, or the live fluid");
}

std::string BakedParticles::description() const {
  return describe(*bake_, "particles") + surface_words(options_.surface) + painted_words(painted_);
}

FrameFacts BakedParticles::prepare(std::int64_t step) {
  bake_->read_frame(step, frame_);
  return to_facts(frame_.facts.time_s, frame_.facts.account);
}

void BakedParticles::draw(const Canvas& canvas) {
  places_ = frame_.particles;
  if (options_.surface == sim::Surface::Ellipsoids) surface_.shape(places_, shapes_);
  particles_.upload(places_, shapes_);
  if (!renderer_) renderer_ = std::make_unique<sim::FluidRenderer>(scene_, options_);
  renderer_->place_obstacles(frame_.facts.time_s);
  const bool foams = bake_->header().max_foam > 0;
  if (foams) foam_.upload(frame_.foam);
  renderer_->draw(particles_, views_on(scene_.view, viewing_, canvas), canvas.framebuffer,
                  foams ? &foam_ : nullptr);
  if (painted_) renderer_->paint(painted_->overlay(frame_.temperature_k), canvas.framebuffer);
}

LiveFluid::LiveFluid(const sim::Scene& scene, double frame_dt_s, std::string description, MakeSimulation make,
                     Viewing viewing, const sim::RenderOptions& options, bool paint_temperature)
    : scene_(scene),
      frame_dt_s_(frame_dt_s),
      make_(std::move(make)),
      viewing_(std::move(viewing)),
      options_(options),
      painted_(painted(scene, paint_temperature)) {
  description_ = std::move(description) + painted_words(painted_);
}

void LiveFluid::start(std::int64_t start_step) {
  prepared_.reset();
  if (started_ && step_ == start_step) return;
  if (!simulation_ || step_ != 0) {
    simulation_ = make_();
    view_.reset();
    if (picture_) picture_->begin(nullptr);
  }
  for (step_ = 0; step_ < start_step; ++step_) advance();
  started_ = true;
}

FrameFacts LiveFluid::prepare(std::int64_t step) {
  if (!simulation_ || step < step_) start(step);
  started_ = false;
  tell_frame_time();
  for (; step_ < step; ++step_) advance();
  return to_facts(static_cast<double>(step_) * frame_dt_s_, simulation_->account());
}

void LiveFluid::tell_frame_time() {
  const auto now = std::chrono::steady_clock::now();
  if (prepared_) simulation_->frame_time(std::chrono::duration<double, std::milli>(now - *prepared_).count());
  prepared_ = now;
}

void LiveFluid::advance() {
  look();
  simulation_->step_frame();
  if (const auto& met = simulation_->account().guards) guards_ = sim::sum(guards_, *met);
}

/// Gives the method the last picture and the gaze in it. Before the first picture, the method uses the axis
/// of the scene's camera.
void LiveFluid::look() {
  if (!picture_ || !view_) return;
  const int width = view_->viewport.width, height = view_->viewport.height;
  std::optional<std::pair<double, double>> point{{0.5 * width, 0.5 * height}};
  sim::Gaze gaze;
  if (stereo_ && viewing_.ray) {
    point.reset();
    if (const auto ray = viewing_.ray()) gaze = gaze_along(scene_.view, *ray);
  } else if (stereo_) {
    point = straight_ahead(*view_);
  } else if (viewing_.gaze) {
    point = viewing_.gaze(width, height);
  }
  if (point) gaze = sim::gaze_through(*view_, point->first, point->second);
  picture_->look(*simulation_, *view_, gaze, visual_scale_);
}

void LiveFluid::draw(const Canvas& canvas) {
  if (!picture_) picture_ = std::make_unique<sim::FluidPicture>(scene_, options_);
  const std::vector<sim::View> views = views_on(scene_.view, viewing_, canvas);
  view_ = views.front();
  stereo_ = views.size() > 1;
  visual_scale_ =
      stereo_ ? 1 : frame_picture(scene_.view, viewing_, canvas.width_px, canvas.height_px).visual_scale();
  picture_->draw(*simulation_, views, canvas.framebuffer);
  if (!painted_) return;
  simulation_->read_field(sim::ParticleField::Temperature, temperature_k_);
  picture_->renderer().paint(painted_->overlay(temperature_k_), canvas.framebuffer);
}

std::unique_ptr<LiveFluid> make_live_fluid(const StimulusChoice& choice,
                                           const std::function<void(int, int)>& settling) {
  sim::Scene scene = sim::read_scene(choice.scene);
  if (choice.overview) scene.view = scene.overview;
  if (choice.effects) scene.effects = *choice.effects;
  if (choice.picture_effects) scene.picture_effects = *choice.picture_effects;
  sim::SimulationOptions options;
  const auto backend = sim::choose_backend(choice.backend);
  const sim::RenderOptions render = render_options(choice);
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
                                  live_effects(choice, scene) + surface_words(render.surface) +
                                  (choice.setting ? ", at " + sim::to_text(*choice.setting) : "");
  // The first call settles the fluid; each later call starts from the settled state.
  const auto make = [scene, options]() mutable {
    auto simulation = sim::make_simulation(scene, options);
    if (!options.start) options.start = simulation->read_state();
    return simulation;
  };
  return std::make_unique<LiveFluid>(sim::acting_scene(scene, options.method), dt, description, make,
                                     choice.viewing, render, choice.paint_temperature);
}

std::unique_ptr<Stimulus> make_stimulus(const StimulusChoice& choice) {
  if (choice.bake.empty()) return make_live_fluid(choice);
  return from_bake(choice);
}

bool shows_pictures(const StimulusChoice& choice) {
  return !choice.bake.empty() && sim::BakeReader(choice.bake).header().has_pictures();
}

}  // namespace study
