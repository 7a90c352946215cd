#include "libstudy/check/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libstudy/display/null.hpp"

namespace study {

namespace {

constexpr std::size_t last_steps = 30;

/// Time of each content step, s: the measured time, or for a step that was not measured the mean of the last
/// 30 measured times.
class Costs {
 public:
  explicit Costs(const std::vector<double>& measured_s) : measured_s_(measured_s) {
    const std::size_t count = std::min(last_steps, measured_s.empty() ? 0 : measured_s.size() - 1);
    if (count == 0) return;
    const auto last = measured_s.end() - static_cast<std::ptrdiff_t>(count);
    later_s_ = std::accumulate(last, measured_s.end(), 0.0) / static_cast<double>(count);
  }
  bool known(std::int64_t step) const { return static_cast<std::size_t>(step) < measured_s_.size(); }
  double of(std::int64_t step) const {
    const auto at = static_cast<std::size_t>(step);
    return at < measured_s_.size() ? measured_s_[at] : later_s_;
  }

 private:
  const std::vector<double>& measured_s_;
  double later_s_ = 0;
};

/// A stimulus that computes nothing. prepare() advances the virtual clock by the measured times to compute
/// all steps since the last call and to draw the last one, but at least by least_s seconds.
class MeasuredProcess final : public Stimulus {
 public:
  MeasuredProcess(const StepTimes& times, std::int64_t start_frame, double least_s, VirtualClock& clock)
      : compute_(times.compute_s),
        draw_(times.draw_s),
        start_frame_(start_frame),
        least_s_(least_s),
        clock_(clock) {}
  std::string description() const override { return "measured"; }
  std::int64_t length() const override { return 0; }
  void start(std::int64_t step) override { step_ = step; }
  FrameFacts prepare(std::int64_t step) override {
    double taken_s = draw_.of(step - start_frame_);
    while (step_ < step) taken_s += compute_.of(++step_ - start_frame_);
    if (begun_) {
      frame_s.push_back(taken_s);
      if (draw_.known(step - start_frame_)) measured = frame_s.size();
    }
    begun_ = true;
    clock_.wait_until(clock_.now_ns() + std::llround(1e9 * std::max(taken_s, least_s_)));
    return {};
  }
  void draw(const Canvas&) override {}

  std::vector<double> frame_s;  ///< time of each frame but the first, s
  std::size_t measured = 0;     ///< number of leading entries of frame_s whose steps were measured

 private:
  Costs compute_, draw_;
  std::int64_t start_frame_, step_ = 0;
  double least_s_;
  VirtualClock& clock_;
  bool begun_ = false;
};

std::vector<std::int64_t> equal_intervals(const FpsSetting& setting) {
  return std::vector<std::int64_t>(static_cast<std::size_t>(frame_count(setting)),
                                   std::llround(1e9 / setting.mean));
}

}  // namespace

std::int64_t content_steps(const Protocol& protocol, const FpsSetting& setting, double refresh_hz) {
  if (protocol.content.real_time) {
    const double ahead_s = setting.profile ? 1e-3 * setting.profile->animation_error_ms : 0;
    return static_cast<std::int64_t>(
        std::ceil((setting.duration_s + ahead_s) / protocol.content.content_step_s));
  }
  if (has_pattern(setting)) {
    const TimingProfile& profile = *setting.profile;
    const auto frames = static_cast<std::int64_t>(pattern_intervals(profile, setting.duration_s, 0).size());
    // Jitter may move the last hitch past the end: more short frames are then shown in its place.
    const bool jitters = profile.kind == ProfileKind::Hitches && profile.jitter > 0;
    return frames + (jitters ? std::llround(std::ceil(1e-3 * profile.hitch_ms * profile.mean_fps)) : 0);
  }
  if (setting.mean > 0) return frame_count(setting);
  return std::max<std::int64_t>(1, std::llround((refresh_hz > 0 ? refresh_hz : 60) * setting.duration_s));
}

Rehearsal rehearse(const Protocol& protocol, const FpsSetting& setting, const StepTimes& times,
                   const std::vector<std::int64_t>& intervals_ns, double refresh_hz) {
  const bool native = !(setting.mean > 0);
  const double least_s = native ? 1 / (refresh_hz > 0 ? refresh_hz : 1e6) : 0;
  VirtualClock clock;
  NullDisplay display;
  MeasuredProcess process(times, protocol.content.start_frame, least_s, clock);
  const ShowingBounds bounds = showing_bounds(protocol.timing, setting.duration_s);
  Rehearsal out;
  out.played = native ? play_native(setting.duration_s, protocol.content, process, display, clock,
                                    bounds.overrun_ns, {})
                      : play_trial(intervals_ns.empty() ? equal_intervals(setting) : intervals_ns,
                                   protocol.content, process, display, clock, bounds, {});
  out.frame_s = std::move(process.frame_s);
  out.measured = process.measured;
  out.showing_s = 1e-9 * static_cast<double>(out.played.end_ns - out.played.frames.front().scheduled_ns);
  return out;
}

}  // namespace study
