#include "apps/study/headset_show.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "libstudy/headset/loader.hpp"
#include "libstudy/headset/session_maker.hpp"
#include "libstudy/headset/system.hpp"
#include "libstudy/headset/test_scene.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

using Seconds = std::chrono::duration<double>;

/// Longest wait until the runtime's state is READY, and until the runtime ends the session.
constexpr Seconds most_idle{30};

/// Direction of a ray relative to the head's forward direction: angle to the right and angle up, degrees.
std::array<double, 2> angles_in_head(const study::HeadsetPose& head, const study::HeadsetPose& ray) {
  const auto axes = study::axes_of(head);
  const auto direction = study::direction_of(ray);
  std::array<double, 3> along{};
  for (std::size_t i = 0; i < 9; ++i)
    along[i / 3] += static_cast<double>(axes[i]) * static_cast<double>(direction[i % 3]);
  const double degree = std::numbers::pi / 180;
  return {std::atan2(along[0], -along[2]) / degree, std::asin(std::clamp(along[1], -1.0, 1.0)) / degree};
}

struct GazeCount {
  std::int64_t samples = 0, valid = 0, tracked = 0, last_ns = -1;
  std::array<double, 2> sum_deg{};

  void add(const study::HeadsetGaze& gaze, const study::HeadsetPose& head) {
    if (gaze.sampled_ns && *gaze.sampled_ns == last_ns) return;  // a slow tracker repeats its last sample
    last_ns = gaze.sampled_ns.value_or(-1);
    ++samples;
    if (!gaze.ray.turn_valid || !head.turn_valid) return;
    ++valid;
    tracked += gaze.ray.turn_tracked;
    const auto angles = angles_in_head(head, gaze.ray);
    for (std::size_t i = 0; i < angles.size(); ++i) sum_deg[i] += angles[i];
  }
};

struct ShowReport {
  std::string headset, ended;
  std::vector<std::string> states, notes;
  std::int64_t frames = 0, shown = 0, dropped = 0, repeated = 0, off_grid = 0, selected = 0, pushed = 0;
  study::HeadsetRate rate;
  bool times_convert = false, has_gaze = false;
  GazeCount gaze;
};

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string rate_text(const study::HeadsetRate& rate) {
  std::string out = rate.measured_hz
                        ? fmt::format("{:.2f} Hz measured from predicted times", *rate.measured_hz)
                        : "not known: too few steps between predicted times";
  if (rate.reported_hz) out += fmt::format("; {:g} Hz reported by the runtime", *rate.reported_hz);
  return out;
}

std::string gaze_text(const ShowReport& report) {
  if (!report.has_gaze) return "none";
  const GazeCount& gaze = report.gaze;
  if (gaze.samples == 0) return "no sample";
  const auto share = [&](std::int64_t part) {
    return 100 * static_cast<double>(part) / static_cast<double>(gaze.samples);
  };
  std::string out = fmt::format("{} samples, {:.1f} % valid, {:.1f} % tracked", gaze.samples,
                                share(gaze.valid), share(gaze.tracked));
  if (gaze.valid > 0)
    out += fmt::format("; on average {:.1f} degrees right, {:.1f} up",
                       gaze.sum_deg[0] / static_cast<double>(gaze.valid),
                       gaze.sum_deg[1] / static_cast<double>(gaze.valid));
  return out;
}

void print_report(const ShowReport& report) {
  const auto row = [](const char* name, const std::string& text) { fmt::print("{:<12}{}\n", name, text); };
  row("shown in", report.headset);
  row("states", joined(report.states));
  row("frames", fmt::format("{}, {} with pictures", report.frames, report.shown));
  row("rate", rate_text(report.rate));
  row("dropped", fmt::format("{} slots; {} predicted times repeated, {} off the grid", report.dropped,
                             report.repeated, report.off_grid));
  row("times", report.times_convert ? "on the system's clock" : "not on the system's clock");
  row("gaze", gaze_text(report));
  row("hands", fmt::format("pressed {} times, stick pushed {} times", report.selected, report.pushed));
  for (const std::string& note : report.notes) row("note", note);
  row("ended", report.ended);
}

/// One OpenXR session that shows the test scene. If the session is lost, show_sessions() makes another Show.
class Show {
 public:
  Show(std::unique_ptr<study::HeadsetSession> session, const study::TestScene& scene,
       const ShowChoice& choice, ShowReport& report)
      : session_(std::move(session)),
        picture_(session_->picture_size().width, session_->picture_size().height),
        scene_(scene),
        report_(report),
        asked_hz_(choice.refresh_hz) {
    report.headset = session_->description();
    report.times_convert = session_->times_convert();
    report.has_gaze = session_->has_eye_gaze();
    if (!session_->keeps_levels()) report.notes.emplace_back("the picture format loses dark levels");
    if (choice.refresh_hz > 0) session_->request_rate(choice.refresh_hz);
  }
  ~Show() {
    report_.dropped += session_->meter().dropped();
    report_.repeated += session_->meter().repeated();
    report_.off_grid += session_->meter().off_grid();
  }
  Show(const Show&) = delete;
  Show& operator=(const Show&) = delete;

  /// Shows the scene until seconds_left have passed or the runtime asks to exit, and then returns true.
  /// Returns false if the session is lost or the runtime ends.
  bool run(double& seconds_left) {
    auto idle_since = std::chrono::steady_clock::now();
    while (true) {
      for (const study::HeadsetEvent& event : session_->poll()) note(event);
      if (session_->state() == study::HeadsetState::Exiting) return true;
      if (session_->state() == study::HeadsetState::LossPending || runtime_ends_) return false;
      if (session_->running()) {
        frame(seconds_left);
        if (seconds_left <= 0 && !asked_to_exit_) ask_to_exit();
        idle_since = std::chrono::steady_clock::now();
        continue;
      }
      if (std::chrono::steady_clock::now() - idle_since > most_idle) {
        throw base::Error(
            "headset",
            fmt::format("the runtime did not {} the session within {:g} s", asked_to_exit_ ? "end" : "begin",
                        most_idle.count()),
            asked_to_exit_ ? "restart the runtime" : "put the headset on and give the command again");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

 private:
  void ask_to_exit() {
    asked_to_exit_ = true;
    report_.ended = "after the time of --show";
    report_.rate = session_->rate();
    const double shown_hz = report_.rate.measured_hz.value_or(report_.rate.reported_hz.value_or(0));
    if (asked_hz_ > 0 && std::abs(shown_hz - asked_hz_) > 0.02 * asked_hz_)
      report_.notes.push_back(fmt::format("the display did not go to {:g} Hz", asked_hz_));
    session_->request_exit();
  }

  void note(const study::HeadsetEvent& event) {
    using Kind = study::HeadsetEvent::Kind;
    if (event.kind == Kind::State) report_.states.emplace_back(study::name_of(event.state));
    if (event.kind == Kind::Refresh)
      report_.notes.push_back(
          fmt::format("refresh went from {:.4g} to {:.4g} Hz", event.from_hz, event.to_hz));
    if (event.kind == Kind::Presence)
      report_.notes.emplace_back(event.worn ? "the headset was put on" : "the headset was taken off");
    if (event.kind == Kind::Recentred) report_.notes.emplace_back("the world was recentred");
    runtime_ends_ |= event.kind == Kind::RuntimeEnds;
    if (event.kind == Kind::EventsLost) report_.notes.emplace_back("the runtime lost events");
  }

  void frame(double& seconds_left) {
    const study::HeadsetSlot slot = session_->wait();
    if (last_ns_) seconds_left -= static_cast<double>(slot.predicted_ns - *last_ns_) * 1e-9;
    last_ns_ = slot.predicted_ns;
    session_->begin(slot);
    take(session_->input(slot));
    const study::EyeViews views = session_->views(slot);
    const bool shows = slot.should_render && study::can_be_shown(views);
    if (shows) {
      for (std::size_t eye = 0; eye < views.size(); ++eye)
        scene_.draw(views[eye], picture_.framebuffer(), eye == 0 ? 0 : views[0].width_px);
    }
    session_->end(slot, {.picture = shows ? &picture_ : nullptr, .views = views});
    ++report_.frames;
    report_.shown += shows;
  }

  void take(const study::HeadsetInput& input) {
    if (input.gaze) report_.gaze.add(*input.gaze, input.head);
    report_.selected += input.hands.select_began;
    const bool pushed = std::hypot(input.hands.stick[0], input.hands.stick[1]) > 0.5f;
    report_.pushed += pushed && !pushed_;
    pushed_ = pushed;
  }

  std::unique_ptr<study::HeadsetSession> session_;
  sim::Offscreen picture_;
  const study::TestScene& scene_;
  ShowReport& report_;
  double asked_hz_;  ///< requested refresh rate, Hz; 0: none
  std::optional<std::int64_t> last_ns_;
  bool asked_to_exit_ = false, runtime_ends_ = false, pushed_ = false;
};

void show_sessions(const ShowChoice& choice, ShowReport& report) {
  const sim::GlContext gl = study::make_headset_context();
  const study::TestScene scene;
  study::SessionMaker sessions(gl, {.eye_gaze = true, .patience_s = choice.patience_s});
  auto session = sessions.make();
  for (double seconds_left = choice.seconds;;) {
    try {
      Show show(std::move(session), scene, choice, report);
      if (show.run(seconds_left)) return;
    } catch (const study::HeadsetLost&) {
    }
    session = sessions.make();
    report.notes.emplace_back("a session was lost and started again");
  }
}

}  // namespace

void show_in_headset(const ShowChoice& choice) {
  ShowReport report;
  report.ended = "the runtime asked to leave";
  try {
    show_sessions(choice, report);
  } catch (...) {
    report.ended = "by an error";
    if (!report.headset.empty()) print_report(report);
    throw;
  }
  print_report(report);
}

}  // namespace apps
