#include "libsim/measure/surface_runs.hpp"

#include <epoxy/gl.h>

#include <cmath>
#include <memory>
#include <string>

#include "libsim/gl/offscreen.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/scene/gaze.hpp"
#include "stats/base/error.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/timing.hpp"

namespace measure {

namespace {

/// A surface's renderer, and its pictures.
struct Drawn {
  Drawn(const sim::Scene& scene, sim::Surface surface, int width, int height)
      : picture(scene, options_of(surface)), target(width, height) {}
  static sim::RenderOptions options_of(sim::Surface surface) {
    sim::RenderOptions out;
    out.surface = surface;
    return out;
  }
  sim::FluidPicture picture;
  sim::Offscreen target;
  sim::Image last;
  std::vector<double> take_ms, draw_ms;
};

std::vector<std::unique_ptr<Drawn>> renderers(const sim::Scene& scene,
                                              const std::vector<sim::Surface>& surfaces, int width,
                                              int height) {
  std::vector<std::unique_ptr<Drawn>> out;
  for (const sim::Surface surface : surfaces)
    out.push_back(std::make_unique<Drawn>(scene, surface, width, height));
  return out;
}

double change_between(const sim::Image& a, const sim::Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) sum += std::abs(static_cast<double>(a.rgba[i]) - static_cast<double>(b.rgba[i]));
  return sum / (0.75 * static_cast<double>(a.rgba.size()));
}

void look_at_gaze(sim::FluidPicture& picture, sim::Simulation& fluid, const sim::Scene& scene,
                  const sim::View& view, double frame_dt_s) {
  const sim::Vec3d at = sim::gaze_point(scene, sim::scene_frame(scene, fluid.frame() + 1, frame_dt_s));
  picture.look(fluid, view, sim::gaze_at(scene.view, at));
}

double frame_dt_of(const sim::Scene& scene, const sim::SimulationOptions& options) {
  return options.frame_dt_s > 0 ? options.frame_dt_s : scene.frame_dt_s;
}

}  // namespace

std::vector<Popping> measure_popping(const sim::Scene& scene, const sim::SimulationOptions& options,
                                     int warm_up, int frames, const base::PictureSize& size,
                                     const std::vector<sim::Surface>& surfaces) {
  const auto fluid = make_settled(scene, options);
  const auto drawn = renderers(scene, surfaces, size.width, size.height);
  const sim::View view = sim::make_view(scene.view, size.width, size.height);
  std::vector<Popping> out(surfaces.size());
  base::Progress progress("frames", static_cast<std::size_t>(warm_up + frames));
  for (int frame = -warm_up; frame <= frames; ++frame) {
    const auto before = fluid->account().particles_by_level;
    if (frame > -warm_up) {
      look_at_gaze(drawn.back()->picture, *fluid, scene, view, frame_dt_of(scene, options));
      fluid->step_frame();
    }
    const bool turned = fluid->account().particles_by_level != before;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      Drawn& one = *drawn[k];
      one.picture.draw(*fluid, view, one.target.framebuffer());
      sim::Image now = one.target.read();
      if (frame > 0) {
        const double change = change_between(one.last, now);
        (turned ? out[k].turning : out[k].other) += change;
        ++(turned ? out[k].turns : out[k].others);
      }
      one.last = std::move(now);
    }
    progress.update(static_cast<std::size_t>(warm_up + frame));
  }
  for (Popping& one : out) {
    if (one.turns == 0 || one.others == 0) {
      throw base::Error("popping of " + scene.name + " over " + std::to_string(frames) + " frames",
                        "needs frames with and without splits or merges", "use more frames");
    }
    one.turning /= one.turns;
    one.other /= one.others;
  }
  return out;
}

std::vector<DrawTimes> measure_draw_times(const sim::Scene& scene, const sim::SimulationOptions& options,
                                          int frames, const base::PictureSize& size, int views,
                                          const std::vector<sim::Surface>& surfaces) {
  const auto fluid = make_settled(scene, options);
  const auto drawn = renderers(scene, surfaces, views * size.width, size.height);
  const std::vector<sim::View> eyes = make_views(scene, size, views);
  constexpr int warm_up = 2;
  for (int frame = -warm_up; frame < frames; ++frame) {
    look_at_gaze(drawn.back()->picture, *fluid, scene, eyes.front(), frame_dt_of(scene, options));
    fluid->step_frame();
    fluid->synchronize();
    for (const auto& one : drawn) {
      const double start = base::milliseconds_now();
      one->picture.take(*fluid);
      if (!one->picture.uploaded()) fluid->synchronize();
      glFinish();
      const double taken = base::milliseconds_now();
      one->picture.show(eyes, one->target.framebuffer());
      glFinish();
      if (frame < 0) continue;
      one->take_ms.push_back(taken - start);
      one->draw_ms.push_back(base::milliseconds_now() - taken);
    }
  }
  std::vector<DrawTimes> out;
  for (const auto& one : drawn)
    out.push_back({base::quantile(one->take_ms, 0.5), base::quantile(one->draw_ms, 0.5)});
  return out;
}

}  // namespace measure
