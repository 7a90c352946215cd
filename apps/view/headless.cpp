#include <epoxy/gl.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#include "apps/common/fluid_picture.hpp"
#include "apps/common/program.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libsim/scene/gaze.hpp"
#include "stats/base/error.hpp"
#include "stats/fps_window.hpp"

namespace apps {

namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::filesystem::path picture_path(const std::string& folder, int frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04d.png", frame);
  return std::filesystem::path(folder) / name;
}

/// Frame intervals without the time that pictures take on their way to the disk.
struct Timing {
  stats::FpsWindow window{30};
  double step_s = 0, draw_s = 0;
  int steps = 0, draws = 0, pictures = 0;
};

void print_timing(const Timing& timing) {
  if (timing.steps) std::printf("step   %8.2f ms a frame\n", 1e3 * timing.step_s / timing.steps);
  if (timing.draws) std::printf("draw   %8.2f ms a frame\n", 1e3 * timing.draw_s / timing.draws);
}

void print_tolerance(const sim::PtpeFile& file, const stats::FpsMoments& fps) {
  std::printf("ptpe   a = %.4f frames/s, b = %.5f s/frame (level %.1f, %d participants)\n", file.model.a,
              file.model.b, file.level, file.n_participants);
  if (fps.frames == 0) {
    std::printf("       no frame rate was measured: tau needs --frames 2 or more\n");
    return;
  }
  const double tau = stats::ptpe_tolerance(file.model, fps.mean, fps.sd);
  std::printf("       over the last %zu frames: mu = %.3f, delta = %.3f frames/s, tau = %.3f, beta = %.4f\n",
              fps.frames, fps.mean, fps.sd, tau, stats::activation_floor(file.model, tau));
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
  const sim::Offscreen target(options.width_px, options.height_px);
  if (!options.png_folder.empty()) make_folder(options.png_folder);
  const PreparedFluid prepared = prepare_fluid(options);
  std::printf("OpenGL: %s\n", sim::gl_description().c_str());
  FluidPicture picture(prepared.scene);
  const sim::View view = sim::make_view(prepared.camera, options.width_px, options.height_px);

  const OverlayKind overlay = parse_overlay(options.overlay);
  OverlayPainter painter(prepared.finest_spacing_m);
  Timing timing;
  Progress progress("frames", static_cast<std::size_t>(options.frames));
  for (int frame = 0; frame < options.frames; ++frame) {
    if (frame > 0) {
      const sim::Vec3d at = sim::gaze_point(prepared.scene, frame);
      picture.look(*prepared.fluid, view, gaze_at(prepared.camera, at));
    }
    const double start = seconds_now();
    if (frame > 0) {
      prepared.fluid->step_frame();
      prepared.fluid->synchronize();
      ++timing.steps;
    }
    const double stepped = seconds_now();
    const bool kept = !options.png_folder.empty() && frame % options.every == 0;
    // tau speaks of frames that are shown, so --ptpe draws them all; saliency reads each picture.
    if (kept || prepared.ptpe || prepared.follows_picture || options.png_folder.empty()) {
      picture.draw(*prepared.fluid, view, target.framebuffer());
      if (kept) painter.paint(overlay, *prepared.fluid, picture, target.framebuffer());
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
    if (kept) {
      sim::write_png(picture_path(options.png_folder, frame), target.read());
      ++timing.pictures;
    }
    progress.update(static_cast<std::size_t>(frame) + 1);
  }
  print_timing(timing);
  if (!painter.legend().empty()) std::printf("paint  %s\n", painter.legend().c_str());
  if (timing.draws) print_render_counts(picture.renderer().counts());
  if (prepared.ptpe) print_tolerance(*prepared.ptpe, timing.window.moments());
  if (timing.pictures) {
    std::printf("%d picture%s in %s\n", timing.pictures, timing.pictures == 1 ? "" : "s",
                options.png_folder.c_str());
  }
}

}  // namespace apps
