#include "libsim/measure/render_timer.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "libsim/gl/offscreen.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "stats/base/timing.hpp"

namespace measure {

void PassTable::add(std::span<const sim::PassTime> picture) {
  for (const sim::PassTime& time : picture) {
    const auto known = std::find_if(passes_.begin(), passes_.end(),
                                    [&](const Pass& pass) { return pass.name == time.pass; });
    Pass& pass = known == passes_.end() ? passes_.emplace_back(Pass{time.pass, {}}) : *known;
    pass.ms.push_back(time.ms);
  }
}

base::Json PassTable::figures() const {
  base::Json out = base::Json::object();
  for (const Pass& pass : passes_) out[pass.name] = base::quantile(pass.ms, 0.5);
  return out;
}

void print_passes(const base::Json& figures) {
  std::vector<std::pair<std::string, double>> passes;
  double sum = 0;
  for (const auto& [pass, ms] : figures.items()) {
    passes.emplace_back(pass, ms.get<double>());
    sum += passes.back().second;
  }
  std::sort(passes.begin(), passes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [pass, ms] : passes) std::printf("    %-12s %7.3f ms\n", pass.c_str(), ms);
  std::printf("    %-12s %7.3f ms\n", "all passes", sum);
}

std::vector<sim::View> make_views(const sim::Scene& scene, const base::PictureSize& size, int count) {
  constexpr float eye_distance_m = 0.064F;
  std::vector<sim::View> views(static_cast<std::size_t>(count),
                               sim::make_view(scene.view, size.width, size.height));
  for (int i = 0; i < count; ++i) {
    auto& view = views[static_cast<std::size_t>(i)];
    view.viewport.x = i * size.width;
    view.view[12] -= (static_cast<float>(i) - 0.5F * static_cast<float>(count - 1)) * eye_distance_m;
  }
  return views;
}

namespace {

sim::RenderOptions timed_passes(sim::Surface surface) {
  sim::RenderOptions options;
  options.surface = surface;
  options.time_passes = true;
  return options;
}

}  // namespace

struct RenderTimer::State {
  base::PictureSize size;
  sim::GlContext context;
  std::vector<sim::View> views;
  sim::Offscreen target;
  sim::FluidPicture picture;
  std::vector<double> transfer_ms, render_ms;
  PassTable passes;

  State(sim::GlContext current, const sim::Scene& scene, const base::PictureSize& chosen, int count,
        sim::Surface surface)
      : size(chosen),
        context(std::move(current)),
        views(make_views(scene, chosen, count)),
        target(count * chosen.width, chosen.height),
        picture(scene, timed_passes(surface)) {}

  void transfer(sim::Simulation& fluid) {
    picture.take(fluid);
    if (!picture.uploaded()) fluid.synchronize();
    glFinish();
  }
};

RenderTimer::RenderTimer(sim::GlContext context, const sim::Scene& scene, const base::PictureSize& size,
                         int views, sim::Surface surface)
    : state_(std::make_unique<State>(std::move(context), scene, size, views, surface)) {}

RenderTimer::~RenderTimer() = default;

void RenderTimer::warm_up(sim::Simulation& fluid) {
  for (int i = 0; i < 2; ++i) draw(fluid);
  state_->transfer_ms.clear();
  state_->render_ms.clear();
  state_->passes.clear();
}

RenderTimer::Times RenderTimer::draw(sim::Simulation& fluid) {
  State& s = *state_;
  const double start = base::milliseconds_now();
  s.transfer(fluid);
  const double moved = base::milliseconds_now();
  s.picture.show(s.views, s.target.framebuffer());
  glFinish();
  const Times times{moved - start, base::milliseconds_now() - moved};
  s.transfer_ms.push_back(times.transfer);
  s.render_ms.push_back(times.render);
  s.passes.add(s.picture.renderer().times());
  return times;
}

void RenderTimer::look(sim::Simulation& fluid) {
  const sim::View& view = state_->views.front();
  const auto& shown = view.viewport;
  state_->picture.look(fluid, view, sim::gaze_through(view, 0.5 * shown.width, 0.5 * shown.height));
}

base::Json RenderTimer::figures() const {
  const State& s = *state_;
  if (s.render_ms.empty()) return nullptr;
  const auto counts = s.picture.renderer().counts();
  return {{"render_ms_median", base::quantile(s.render_ms, 0.5)},
          {"render_ms_p95", base::quantile(s.render_ms, 0.95)},
          {"render_ms_p99", base::quantile(s.render_ms, 0.99)},
          {"transfer_ms_median", base::quantile(s.transfer_ms, 0.5)},
          {"transfer_ms_p95", base::quantile(s.transfer_ms, 0.95)},
          {"transfer_ms_p99", base::quantile(s.transfer_ms, 0.99)},
          {"transfer", s.picture.uploaded() ? "uploaded" : "shared with CUDA"},
          {"render_width_px", s.size.width},
          {"render_height_px", s.size.height},
          {"render_views", s.views.size()},
          {"opengl", sim::gl_description()},
          {"render_front_missing", counts.front_missing},
          {"render_beyond_walls", counts.beyond_walls},
          {"passes", s.passes.figures()}};
}

void print_render_figures(const base::Json& figures) {
  std::printf("  transfer     %8.3f ms a frame (median), %.3f p95, %.3f p99; %s\n",
              figures["transfer_ms_median"].get<double>(), figures["transfer_ms_p95"].get<double>(),
              figures["transfer_ms_p99"].get<double>(), figures["transfer"].get<std::string>().c_str());
  std::printf("  render       %8.3f ms a frame (median), %.3f p95, %.3f p99; %d x %dx%d px on %s\n",
              figures["render_ms_median"].get<double>(), figures["render_ms_p95"].get<double>(),
              figures["render_ms_p99"].get<double>(), figures["render_views"].get<int>(),
              figures["render_width_px"].get<int>(), figures["render_height_px"].get<int>(),
              figures["opengl"].get<std::string>().c_str());
  print_passes(figures["passes"]);
}

}  // namespace measure
