#include <epoxy/gl.h>
#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/fps_window.hpp"

namespace apps {

namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// File of a picture, such as frame_0040.png; with several overlays, frame_0040_level.png for the overlay
/// "level".
std::filesystem::path picture_path(const std::string& folder, int frame, OverlayKind overlay, bool several) {
  std::string name = fmt::format("frame_{:04}", frame);
  if (several && overlay != OverlayKind::None)
    name += "_" + overlay_names()[static_cast<std::size_t>(overlay)];
  return std::filesystem::path(folder) / (name + ".png");
}

/// Writes the pictures of a frame, one per overlay.
class PictureFolder {
 public:
  explicit PictureFolder(const ViewOptions& options)
      : folder_(options.png_folder), overlays_(parse_overlays(options.overlay)) {
    if (!folder_.empty()) base::make_folder(folder_);
  }

  /// Writes the pictures of the frame that `picture` has just drawn.
  void write(int frame, const PreparedFluid& prepared, sim::FluidPicture& picture, const sim::View& view,
             const sim::Offscreen& target) {
    sim::Simulation& fluid = *prepared.fluid;
    OverlayPainter painter(drawn(prepared), prepared.finest_spacing_m);
    legends_.clear();
    for (std::size_t i = 0; i < overlays_.size(); ++i) {
      if (i > 0) picture.draw(fluid, view, target.framebuffer());
      painter.paint(overlays_[i], fluid, picture, target.framebuffer());
      if (!painter.legend().empty()) legends_.push_back(painter.legend());
      sim::write_png(picture_path(folder_, frame, overlays_[i], overlays_.size() > 1), target.read());
      ++written_;
    }
  }
  void print() const {
    for (const auto& legend : legends_) std::printf("paint  %s\n", legend.c_str());
    if (written_) std::printf("%d picture%s in %s\n", written_, written_ == 1 ? "" : "s", folder_.c_str());
  }

 private:
  std::string folder_;
  std::vector<OverlayKind> overlays_;
  std::vector<std::string> legends_;
  int written_ = 0;
};

/// Number of last frames over which --ptpe measures the frame rate.
constexpr int last_frames = 30;

/// Times of steps and drawing, without the time for writing pictures.
struct Timing {
  stats::FpsWindow window{last_frames};
  double step_s = 0, draw_s = 0;
  int steps = 0, draws = 0;
};

void print_timing(const Timing& timing, int frames, const PreparedFluid& prepared) {
  if (timing.steps) std::printf("step   %8.2f ms a frame\n", 1e3 * timing.step_s / timing.steps);
  if (!timing.draws) return;
  std::printf("draw   %8.2f ms a frame\n", 1e3 * timing.draw_s / timing.draws);
  if (timing.draws == frames) return;
  const std::string measured =
      prepared.ptpe ? fmt::format(" and the last {}, whose rate is measured", last_frames) : "";
  std::printf("       %d of %d frames were drawn: those of the pictures%s\n", timing.draws, frames,
              measured.c_str());
}

/// True if the frame must be drawn. Without --png every frame is drawn. Otherwise a frame is drawn if its
/// picture is stored, if the method reads every picture, if pictures depend on those before, or if --ptpe
/// measures the frame rate in this frame.
bool is_drawn(int frame, int frames, bool kept, const ViewOptions& options, const PreparedFluid& prepared) {
  if (kept || options.png_folder.empty() || prepared.fluid->needs_every_picture()) return true;
  return prepared.ptpe && (prepared.follows_rate || frame >= frames - last_frames);
}

void print_tolerance(const sim::PtpeFile& file, const stats::FpsMoments& fps) {
  std::printf("ptpe   %s\n", sim::describe(file).c_str());
  if (fps.frames == 0) {
    std::printf("       no frame rate was measured: tau needs --frames 2 or more\n");
    return;
  }
  const double tau = stats::ptpe_tolerance(file.model, fps);
  std::printf("       over the last %zu frames: mu = %.3f, delta = %.3f frames/s, tau = %.3f, beta = %.4f\n",
              fps.frames, fps.mean_of(file.model.mean), fps.sd, tau,
              stats::activation_floor(file.model, tau));
}

void print_render_counts(const sim::RenderCounts& c) {
  if (c.not_finite) std::printf("render %u particles were not finite and were skipped\n", c.not_finite);
  if (c.thickness_full) std::printf("render thickness saturated in %u cells\n", c.thickness_full);
  if (c.filter_capped) std::printf("render the depth filter stopped short in %u px\n", c.filter_capped);
  if (c.front_missing)
    std::printf("render %u px have no front particle: the driver is faulty\n", c.front_missing);
}

}  // namespace

void run_headless(const ViewOptions& options) {
  auto context = sim::GlContext::make_headless();
  const sim::Offscreen target(options.size.width, options.size.height);
  PictureFolder pictures(options);
  const PreparedFluid prepared = prepare_fluid(options);
  std::printf("OpenGL: %s\n", sim::gl_description().c_str());
  sim::FluidPicture picture(drawn(prepared), render_options(options));
  const sim::View view = sim::make_view(prepared.camera, options.size.width, options.size.height);

  Timing timing;
  constexpr int usual_frames = 100;
  const int frames = options.frames.value_or(usual_frames);
  base::Progress progress("frames", static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame) {
    if (frame > 0) {
      const sim::Vec3d at =
          sim::gaze_point(prepared.scene, sim::scene_frame(prepared.scene, frame, prepared.frame_dt_s));
      picture.look(*prepared.fluid, view, sim::gaze_at(prepared.camera, at));
    }
    const double start = seconds_now();
    if (frame > 0) {
      prepared.fluid->step_frame();
      prepared.fluid->synchronize();
      ++timing.steps;
    }
    const double stepped = seconds_now();
    const bool kept = !options.png_folder.empty() && frame % options.every == 0;
    if (is_drawn(frame, frames, kept, options, prepared)) {
      picture.draw(*prepared.fluid, view, target.framebuffer());
      glFinish();
      ++timing.draws;
    }
    const double drawn = seconds_now();
    if (frame > 0) {
      timing.window.push(drawn - start);
      prepared.fluid->frame_time(1e3 * (drawn - start));
      timing.step_s += stepped - start;
    }
    timing.draw_s += drawn - stepped;
    if (kept) pictures.write(frame, prepared, picture, view, target);
    progress.update(static_cast<std::size_t>(frame) + 1);
  }
  sim::check_finite(*prepared.fluid, options.scene);
  print_timing(timing, frames, prepared);
  if (prepared.follows_picture)
    std::printf("seen   %s\n", sim::in_words(prepared.fluid->report().seen).c_str());
  if (timing.draws) print_render_counts(picture.renderer().counts());
  if (prepared.ptpe) print_tolerance(*prepared.ptpe, timing.window.moments());
  pictures.print();
  sim::print_guards(options.scene, *prepared.fluid);
}

}  // namespace apps
