#include <epoxy/gl.h>

#include <chrono>

#include "apps/common/fluid_picture.hpp"
#include "apps/common/program.hpp"
#include "apps/study/check/measured_check.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/scene/settled_state.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// One frame as a session shows it; seconds.
double run_frame(sim::Simulation& fluid, FluidPicture& picture, const sim::View& view, const sim::Gaze& gaze,
                 unsigned framebuffer) {
  const double start = seconds_now();
  picture.look(fluid, view, gaze);
  fluid.step_frame();
  fluid.synchronize();
  picture.draw(fluid, view, framebuffer);
  glFinish();
  const double taken = seconds_now() - start;
  fluid.frame_time(1000 * taken);
  return taken;
}

MeasuredStimulus measure(const study::StimulusSpec& what, double content_step_s,
                         const MeasureOptions& options) {
  const sim::Scene scene = sim::read_scene(base::find_input(what.scene));
  sim::SimulationOptions choice;
  choice.method = sim::parse_method(what.method);
  choice.n_star = sim::parse_n_star(what.n_star);
  choice.backend = sim::choose_backend(options.backend);
  choice.frame_dt_s = content_step_s;
  choice.cache = sim::default_cache_folder();
  const auto fluid = sim::make_simulation(scene, choice);
  FluidPicture picture(scene);
  const sim::Offscreen target(options.width_px, options.height_px);
  const sim::View view = sim::make_view(scene.view, options.width_px, options.height_px);
  MeasuredStimulus out;
  out.what = what;
  out.temporal = sim::traits_of(choice.method).temporal;
  const double start = seconds_now();
  for (int frame = 1; frame <= options.warm_up + options.frames; ++frame) {
    const auto gaze = gaze_at(scene.view, sim::gaze_point(scene, frame));
    const double taken_s = run_frame(*fluid, picture, view, gaze, target.framebuffer());
    if (frame > options.warm_up) out.frame_s.push_back(taken_s);
    if (!out.frame_s.empty() && seconds_now() - start > options.most_s) break;
  }
  return out;
}

}  // namespace

std::vector<MeasuredStimulus> measure_stimuli(const study::Protocol& protocol,
                                              const MeasureOptions& options) {
  const auto stimuli = stimuli_of(protocol);
  const auto context = sim::GlContext::make_headless();
  Progress progress("stimuli", stimuli.size());
  std::vector<MeasuredStimulus> out;
  for (const auto& what : stimuli) {
    out.push_back(measure(what, protocol.content.content_step_s, options));
    progress.update(out.size());
  }
  return out;
}

}  // namespace apps
