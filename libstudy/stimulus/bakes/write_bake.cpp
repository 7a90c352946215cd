#include "libstudy/stimulus/bakes/write_bake.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "libsim/gl/offscreen.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/progress.hpp"

namespace study {

namespace {

/// Reads a picture with its lowest row first, the order of a bake.
std::vector<std::uint8_t> read_upwards(const sim::Offscreen& from) {
  std::vector<std::uint8_t> picture = from.read().rgba;
  const auto row = static_cast<std::ptrdiff_t>(4 * from.width());
  for (auto top = picture.begin(), bottom = picture.end() - row; top < bottom; top += row, bottom -= row)
    std::swap_ranges(top, top + row, bottom);
  return picture;
}

/// Makes a Viewing::gaze that follows the scene's gaze keys at the current value of `frame`.
auto gaze_by_keys(const BakeOrder& order, const sim::Scene& scene, const std::int64_t& frame,
                  double frame_dt_s) {
  const sim::Camera camera = order.fluid.overview ? scene.overview : scene.view;
  return [&frame, scene, camera, frame_dt_s, viewing = order.fluid.viewing](int width, int height) {
    const sim::View view = framed_view(camera, viewing, width, height);
    return place_in(view, sim::gaze_point(scene, sim::scene_frame(scene, frame, frame_dt_s)));
  };
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Calls read(frame) for all frames and returns the speed in frames per second.
template <typename Read>
double read_all(const char* label, std::int64_t frames, const std::function<void()>& stop, Read read) {
  base::Progress progress(label, static_cast<std::size_t>(frames));
  const double start_s = seconds_now();
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    stop();
    read(frame);
    progress.update(static_cast<std::size_t>(frame + 1));
  }
  return static_cast<double>(frames) / std::max(1e-9, seconds_now() - start_s);
}

}  // namespace

sim::BakeSizes write_bake(const BakeOrder& order, sim::BakeHeader header, const std::filesystem::path& out,
                          bool overwrite, const BakeHooks& hooks) {
  sim::BakeWriter::check_target(out, overwrite);
  StimulusChoice choice = order.fluid;
  std::int64_t frame = 0;
  if (header.view.gaze == "scene")
    choice.viewing.gaze =
        gaze_by_keys(order, sim::parse_scene(header.scene_text, header.scene_name), frame, header.frame_dt_s);
  std::optional<sim::Offscreen> target;
  if (draws(header)) {
    header.view.renderer = sim::gl_description();
    target.emplace(header.view.width_px, header.view.height_px);
  }
  const auto fluid = make_live_fluid(choice, [&](int done, int total) {
    hooks.stop();
    if (hooks.settling) hooks.settling(done, total);
  });
  fluid->start(0);
  header.backend = sim::backend_name(sim::choose_backend(choice.backend));
  header.max_particles = fluid->simulation().particle_capacity();
  header.radius_by_level_m = fluid->simulation().radii_m();

  sim::BakeWriter writer(out, header, overwrite);
  std::vector<sim::RenderParticle> particles, foam;
  std::vector<float> temperature_k;
  for (frame = 0; frame < header.frame_count; ++frame) {
    hooks.stop();
    const FrameFacts facts = fluid->prepare(frame);
    fluid->simulation().read_particles(particles);
    if (header.reference_k) fluid->simulation().read_field(sim::ParticleField::Temperature, temperature_k);
    writer.add_frame(facts.simulation_time_s, particles, fluid->simulation().account(), temperature_k);
    if (header.max_foam > 0) {
      fluid->simulation().read_foam(foam);
      writer.add_foam(foam);
    }
    if (target) fluid->draw({target->framebuffer(), target->width(), target->height()});
    if (header.has_pictures()) writer.add_picture(read_upwards(*target));
    if (hooks.frames) hooks.frames(frame + 1);
  }
  sim::check_finite(fluid->simulation(), out.string());
  sim::print_guards(out.string(), fluid->simulation());
  return writer.finish();
}

ReadingSpeed read_whole(const sim::BakeReader& bake, const std::function<void()>& stop) {
  const std::int64_t frames = bake.header().frame_count;
  sim::BakeFrame frame;
  ReadingSpeed speed;
  speed.particles = read_all("particles", frames, stop, [&](auto i) {
    bake.read_frame(i, frame);
    speed.temperature_error_k = std::max(speed.temperature_error_k, frame.temperature_error_k);
  });
  if (!bake.header().has_pictures()) return speed;
  sim::PictureReader reader(bake);
  speed.pictures = read_all("pictures", frames, stop, [&](auto i) { reader.read(i); });
  return speed;
}

}  // namespace study
