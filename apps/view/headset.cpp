#include <fmt/core.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "apps/view/options.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libstudy/headset/headset_recorder.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "stats/base/error.hpp"
#include "stats/fps_window.hpp"

namespace apps {

namespace {

std::sig_atomic_t volatile interrupted = 0;

/// While this object exists, Ctrl-C stops the viewer after the current frame, so that the OpenXR session ends
/// in order.
class Interrupt {
 public:
  Interrupt() : before_(std::signal(SIGINT, [](int) { interrupted = 1; })) { interrupted = 0; }
  ~Interrupt() { std::signal(SIGINT, before_); }
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  void (*before_)(int);
};

struct Shown {
  int frames = 0;
  stats::FpsWindow fps{30};
  std::string ended;
};

/// Shows the scene in a headset in real time, or slower if computing the fluid takes longer.
class HeadsetViewer {
 public:
  HeadsetViewer(study::HeadsetDisplay& display, const ViewOptions& options)
      : scene_(options.scene),
        frames_(options.frames),
        display_(display),
        clock_(display),
        recorder_(display,
                  display.session().eye_gaze ? study::GazeOrigin::Tracker : study::GazeOrigin::Head) {
    recorder_.start();  // lets recorder_.ray() use the tracker; the viewer discards the samples
    fmt::print("shown in    {}\n", display.description());
    fmt::print("levels      follow {}\n",
               display.session().eye_gaze ? "the eye tracker" : "the head's direction");
    PreparedFluid prepared = prepare_fluid(options);
    prepared.scene.view = prepared.camera;
    frame_ns_ = std::llround(1e9 * prepared.frame_dt_s);
    study::Viewing viewing;
    viewing.ray = [this] { return recorder_.ray(); };
    // Returns the prepared fluid at the first call. No second fluid is needed, because the steps of the
    // viewer never go back.
    const auto fluid = std::make_shared<std::unique_ptr<sim::Simulation>>(std::move(prepared.fluid));
    const auto make = [fluid] { return std::move(*fluid); };
    fluid_.emplace(prepared.scene, prepared.frame_dt_s, prepared.scene.name, make, viewing,
                   render_options(options));
  }

  Shown run() {
    Shown shown;
    try {
      play(shown);
    } catch (const base::Error&) {
      if (display_.facts().state != study::HeadsetState::Exiting) throw;
      shown.ended = "the headset's software asked to leave";
    }
    if (shown.frames > 0) sim::print_guards(scene_, fluid_->simulation());
    return shown;
  }

 private:
  void play(Shown& shown) {
    std::int64_t due_ns = 0, on_ns = 0;
    while (!interrupted && (!frames_ || shown.frames < *frames_)) {
      if (!seen()) {  // the fluid waits until the headset is worn
        on_ns = 0;
        display_.turn();
        continue;
      }
      display_.take_spoilt();  // discards a cause for cutting: the viewer cuts no showing
      const std::int64_t before_ns = display_.now_ns();
      fluid_->prepare(shown.frames);
      recorder_.take();
      recorder_.take_slots();
      display_.render(*fluid_);
      const std::int64_t computed_ns = display_.now_ns() - before_ns;
      // Shows the frame in the slot nearest to the due time, or in the first slot that can still be reached.
      const auto period_ns = std::llround(1e9 / display_.refresh_hz());
      const auto times = display_.present(display_.first_onset(due_ns - period_ns / 2), clock_);
      if (on_ns > 0 && times.predicted_display_ns > on_ns)
        shown.fps.push(1e-9 * static_cast<double>(times.predicted_display_ns - on_ns));
      on_ns = times.predicted_display_ns;
      if (on_ns > due_ns + period_ns) due_ns = on_ns;  // a delay postpones all later frames
      due_ns += frame_ns_;
      ++shown.frames;
      display_.hold(due_ns - computed_ns, clock_);
    }
    shown.ended = interrupted ? "by Ctrl-C" : "after its frames";
  }

  bool seen() const {
    const study::HeadsetState state = display_.facts().state;
    return state == study::HeadsetState::Visible || state == study::HeadsetState::Focused;
  }

  std::string scene_;
  std::optional<int> frames_;
  study::HeadsetDisplay& display_;
  study::HeadsetClock clock_;
  study::HeadsetRecorder recorder_;
  std::optional<study::LiveFluid> fluid_;
  std::int64_t frame_ns_ = 0;  ///< duration of a frame of the fluid, ns
};

void print(const Shown& shown) {
  const stats::FpsMoments fps = shown.fps.moments();
  fmt::print("frames      {}, of the last {} mean {:.1f}, SD {:.1f} frames/s\n", shown.frames, fps.frames,
             fps.mean, fps.sd);
  fmt::print("ended       {}\n", shown.ended);
}

/// Connects to a headset. If this fails, prints the reason and returns null; on the virtual clock, throws the
/// error.
std::unique_ptr<study::HeadsetDisplay> connect(const std::string& clock) {
  const bool stands_still = clock == "virtual";
  study::HeadsetRules rules;
  rules.hold = study::Hold::State;
  ::setenv("XR_LOADER_DEBUG", "none", 0);  // silences the loader, because the program prints one line itself
  try {
    return std::make_unique<study::HeadsetDisplay>(
        stands_still ? study::SlotDrive::Caller : study::SlotDrive::Thread,
        study::HeadsetChoice{.eye_gaze = true}, rules);
  } catch (const base::Error& error) {
    if (stands_still) throw;  // on the virtual clock no person watches, so there is no desktop view
    const std::string told = error.what();
    fmt::print(stderr, "no headset: {}; shown on the desktop\n", told.substr(0, told.find('\n')));
    return nullptr;
  }
}

}  // namespace

void run_in_headset(const ViewOptions& options) {
  if (options.overlay != "none")
    throw base::Error("--overlay " + options.overlay, "is not painted in a headset",
                      "leave it out, or use --display window");
  const auto display = connect(options.clock);
  if (!display) return run_window(options);
  const Interrupt interrupt;
  print(HeadsetViewer(*display, options).run());
}

}  // namespace apps
