// epoxy must be included before GLFW, so that GLFW does not include the system's GL headers.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>

#include <cstdio>
#include <string>

#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "apps/view/window/panel.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/gl/offscreen.hpp"
#include "libsim/gl/png.hpp"
#include "libsim/methods/preset.hpp"
#include "libsim/ptpe/tolerance_switch.hpp"
#include "libsim/render/fluid_picture.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libstudy/window/glfw_window.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

constexpr double progress_every_s = 0.1;

/// Thrown by the settling callback if the user closed the window.
struct Closed {};

/// The scene with all listed effects, because the user may turn on any of them later.
sim::Scene as_listed(const PreparedFluid& prepared) {
  sim::Scene out = prepared.scene;
  out.effects = prepared.listed;
  return out;
}

struct Running {
  Running(PreparedFluid fluid, const sim::RenderOptions& options)
      : prepared(std::move(fluid)),
        picture(as_listed(prepared), options),
        painter(drawn(prepared), prepared.finest_spacing_m) {}

  PreparedFluid prepared;
  sim::FluidPicture picture;
  OverlayPainter painter;
  stats::FpsWindow fps{30};
  bool timed = false;   ///< the passes of the fluid are timed
  double shown_s = -1;  ///< time at which the last frame was shown; < 0 after a pause
};

/// The options with method and preset in the spelling of the combo boxes.
ViewOptions spelled_out(ViewOptions options) {
  options.method = sim::method_name(sim::parse_method(options.method));
  options.preset = sim::preset_name(sim::parse_preset(options.preset));
  return options;
}

class Viewer {
 public:
  explicit Viewer(const ViewOptions& options)
      : running_(spelled_out(options)),
        window_({"vip-view", options.size.width, options.size.height, 0,
                 "use --headless --png FOLDER on a machine without a display"}),
        panel_(window_.get(), running_),
        fixed_tau_(sim::parse_tau(options.tau)) {
    sim::require_gl45();
    controls_.chosen = running_;
    controls_.overlay = parse_overlay(options.overlay);
    take(make_fluid(running_));
  }

  void run();

 private:
  std::unique_ptr<Running> make_fluid(const ViewOptions& options);
  void take(std::unique_ptr<Running> fluid);
  void tell_end() const { sim::print_guards(running_.scene, *fluid_->prepared.fluid); }
  void begin_anew();
  void follow_keys();
  void follow_choices();
  void follow_schedule();
  void exchange_effects();
  void step(const sim::View& view);
  stats::PtpeModel model() const {
    return fluid_->prepared.ptpe ? fluid_->prepared.ptpe->model : stats::PtpeModel{};
  }
  void note_time(bool stepped);
  void save_screenshot(int width, int height);

  ViewOptions running_;  ///< the options of the running fluid
  study::GlfwWindow window_;
  Panel panel_;
  Controls controls_;
  Figures figures_;
  std::optional<double> fixed_tau_;
  std::unique_ptr<Running> fluid_;
};

/// Makes and settles a fluid while the window shows the progress.
std::unique_ptr<Running> Viewer::make_fluid(const ViewOptions& options) {
  const std::string what = scene_title(options.scene) + ", " + options.method + ", n_* " + options.n_star;
  double shown_s = -progress_every_s;
  const auto show = [&](int done, int total) {
    if (glfwGetTime() - shown_s < progress_every_s && done < total) return;
    shown_s = glfwGetTime();
    glfwPollEvents();
    if (window_.asked_to_close()) throw Closed{};
    const auto size = window_.size();
    glViewport(0, 0, size.width, size.height);
    glClearColor(0.08F, 0.09F, 0.10F, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    const std::string settled =
        done > 0 ? ": settled " + std::to_string(done) + " of " + std::to_string(total) + " frames" : "";
    panel_.draw_progress(what + settled, static_cast<float>(done) / static_cast<float>(total));
    glfwSwapBuffers(window_.get());
  };
  show(0, 1);
  return std::make_unique<Running>(prepare_fluid(options, show), render_options(options));
}

void Viewer::take(std::unique_ptr<Running> fluid) {
  fluid_ = std::move(fluid);
  const PreparedFluid& prepared = fluid_->prepared;
  figures_.frame = 0;
  figures_.fps = {};
  figures_.frame_ms = 0;
  figures_.strip.clear();
  figures_.particles = prepared.fluid->particle_count();
  figures_.model = fixed_tau_ ? "fixed" : prepared.ptpe ? "fitted" : "the paper's PTPE@4.0";
  figures_.tau = fixed_tau_.value_or(0);
  figures_.beta = stats::activation_floor(model(), figures_.tau);
  const sim::LiveNumbers numbers = prepared.fluid->live_numbers();
  controls_.alpha = numbers.alpha;
  controls_.iterations = numbers.iterations;
  controls_.switches = switches_of(prepared.listed, prepared.scene.effects);
  figures_.price = price_lines(controls_.chosen, prepared.setting, prepared.scene);
}

/// Makes a fluid for the chosen options. If this fails, the old fluid remains and the panel shows the error.
void Viewer::begin_anew() {
  // Resets the choice of effects, which was made for the old scene.
  if (controls_.chosen.scene != running_.scene) {
    controls_.chosen.effects.reset();
    controls_.chosen.effects_off.clear();
  }
  try {
    auto fluid = make_fluid(controls_.chosen);
    tell_end();
    take(std::move(fluid));
    running_ = controls_.chosen;
    figures_.said.clear();
  } catch (const base::Error& error) {
    controls_.chosen = running_;
    figures_.said = error.what();
  }
}

void Viewer::follow_keys() {
  for (const int key : window_.take_keys()) {
    if (panel_.has_keys()) continue;
    if (key == GLFW_KEY_SPACE) controls_.paused = !controls_.paused;
    if (key == GLFW_KEY_S) controls_.step_once = true;
    if (key == GLFW_KEY_R) controls_.restart = true;
    if (key == GLFW_KEY_P) controls_.screenshot = true;
    if (key == GLFW_KEY_T) controls_.schedule = !controls_.schedule;
    const auto number = static_cast<std::size_t>(key - GLFW_KEY_1);
    if (key < GLFW_KEY_1 || number >= controls_.switches.size()) continue;
    controls_.switches[number].on = !controls_.switches[number].on;
    drop_what_cannot_run(controls_.switches);
    controls_.chosen.effects = turned_on(controls_.switches);
  }
}

/// Starts or stops the timing of passes; they are timed only while the schedule is shown.
void Viewer::follow_schedule() {
  if (fluid_->timed == controls_.schedule) return;
  fluid_->prepared.fluid->time_passes(controls_.schedule);
  fluid_->timed = controls_.schedule;
  figures_.passes.clear();
}

/// Sets the chosen effects of the fluid. If the fluid refuses them, the old effects remain and the panel
/// shows the error.
void Viewer::exchange_effects() {
  PreparedFluid& prepared = fluid_->prepared;
  const auto chosen = controls_.chosen.effects.value_or(prepared.scene.effects);
  try {
    if (chosen != prepared.scene.effects) {
      prepared.fluid->set_effects(chosen);
      prepared.scene.effects = chosen;
      fluid_->painter = OverlayPainter(drawn(prepared), prepared.finest_spacing_m);
      std::printf("frame %d: %zu passes, with %s\n", figures_.frame, prepared.fluid->passes().size(),
                  in_words(chosen).c_str());
      std::fflush(stdout);
      figures_.said.clear();
    }
  } catch (const base::Error& error) {
    controls_.chosen.effects = running_.effects;
    figures_.said = error.what();
  }
  controls_.switches = switches_of(prepared.listed, prepared.scene.effects);
}

void Viewer::follow_choices() {
  const Change change = controls_.restart ? Change::Fluid : change_between(running_, controls_.chosen);
  controls_.restart = false;
  if (change == Change::Fluid) return begin_anew();
  if (change == Change::Nothing) return;
  exchange_effects();
  sim::Simulation& fluid = *fluid_->prepared.fluid;
  sim::LiveNumbers numbers = fluid.live_numbers();
  numbers.alpha = controls_.chosen.alpha.value_or(numbers.alpha);
  numbers.iterations = controls_.chosen.iterations.value_or(numbers.iterations);
  fluid.change(numbers);
  controls_.alpha = numbers.alpha;
  controls_.iterations = numbers.iterations;
  running_ = controls_.chosen;
  sim::SolverSetting& setting = fluid_->prepared.setting;
  setting[sim::SolverKnob::Alpha] = numbers.alpha;
  setting[sim::SolverKnob::Iterations] = numbers.iterations;
  figures_.price = price_lines(running_, setting, fluid_->prepared.scene);
}

void Viewer::step(const sim::View& view) {
  const PreparedFluid& prepared = fluid_->prepared;
  sim::Gaze gaze = sim::gaze_at(
      prepared.camera, sim::gaze_point(prepared.scene, sim::scene_frame(prepared.scene, figures_.frame + 1,
                                                                        prepared.frame_dt_s)));
  if (controls_.mouse_gaze) {
    // If the mouse is over the panel or outside the window, the gaze is invalid.
    double x = 0, y = 0;
    const bool looks = window_.mouse(x, y) && !panel_.has_mouse();
    gaze = looks ? sim::gaze_through(view, x, y) : sim::Gaze{};
  }
  fluid_->picture.look(*prepared.fluid, view, gaze);
  prepared.fluid->step_frame();
  figures_.frame = prepared.fluid->frame();
  controls_.step_once = false;
}

/// Records the time from one step to the next; ignores pauses and settling.
void Viewer::note_time(bool stepped) {
  const double now_s = glfwGetTime();
  const double interval_s = now_s - fluid_->shown_s;
  const bool whole = stepped && fluid_->shown_s >= 0 && interval_s > 0;
  fluid_->shown_s = stepped ? now_s : -1;
  if (!whole) return;
  fluid_->fps.push(interval_s);
  fluid_->prepared.fluid->frame_time(1e3 * interval_s);
  if (fluid_->timed) figures_.passes.push(fluid_->prepared.fluid->passes(), interval_s);
  figures_.frame_ms = 1e3 * interval_s;
  figures_.strip.push(figures_.frame_ms);
  figures_.fps = fluid_->fps.moments();
  figures_.tau = fixed_tau_.value_or(stats::ptpe_tolerance(model(), figures_.fps));
  figures_.beta = stats::activation_floor(model(), figures_.tau);
}

void Viewer::save_screenshot(int width, int height) {
  const std::string name = screenshot_name(running_, figures_.frame);
  try {
    sim::write_png(name, sim::read_framebuffer(0, width, height));
    figures_.said = "saved " + name;
  } catch (const base::Error& error) {
    figures_.said = error.what();
  }
  fluid_->shown_s = -1;
  controls_.screenshot = false;
}

void Viewer::run() {
  while (!window_.asked_to_close()) {
    glfwPollEvents();
    const auto [width, height] = window_.size();
    if (width < 1 || height < 1) {  // the window is minimised
      glfwWaitEvents();
      fluid_->shown_s = -1;
      continue;
    }
    const sim::View view = sim::make_view(fluid_->prepared.camera, width, height);
    const bool stepped = !controls_.paused || controls_.step_once;
    if (stepped) step(view);
    sim::Simulation& fluid = *fluid_->prepared.fluid;
    fluid_->picture.draw(fluid, view, 0);
    fluid_->painter.paint(controls_.overlay, fluid, fluid_->picture, 0);
    if (controls_.screenshot) save_screenshot(width, height);
    figures_.particles = fluid.particle_count();
    figures_.legend = fluid_->painter.legend();
    panel_.draw(controls_, figures_);
    glfwSwapBuffers(window_.get());
    note_time(stepped);
    follow_keys();
    follow_choices();
    follow_schedule();
  }
  tell_end();
}

}  // namespace

void run_window(const ViewOptions& options) {
  try {
    Viewer(options).run();
  } catch (const Closed&) {
    // The user closed the window while a fluid settled.
  }
}

}  // namespace apps
