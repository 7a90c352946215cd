#pragma once
/// Plays a schedule on a clock and judges the realised timing.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "stats/fps_window.hpp"

namespace study {

enum class AtEnd { Loop, Hold };

/// How content advances. per_frame: frame i shows step start_frame + i (the paper's reading). real_time:
/// frame i shows the step at the scheduled time since the first frame. A process of finite length goes back
/// to start_frame (Loop) or stays at its last step (Hold).
struct ContentRules {
  bool real_time = false;
  double content_step_s = 1.0 / 60;
  std::int64_t start_frame = 0;
  AtEnd at_end = AtEnd::Loop;
  double latency_s = 0;  ///< real_time: the content lags behind its frame by this
  /// real_time: the content's step between two frames differs from the frame's interval by this, alternately
  /// more and less, s. Content never runs backwards, so a larger error than an interval is cut to it.
  double animation_error_s = 0;
};

/// The rules for one setting: with the latency and the animation error of its profile.
ContentRules content_of(ContentRules rules, const FpsSetting& setting);

/// One shown frame. Times are nanoseconds on the session's clock; -1 = not known.
struct FrameRecord {
  std::int64_t index = 0;
  std::int64_t content_step = 0;
  std::int64_t scheduled_ns = 0;
  PresentTimes times;
  bool late = false;  ///< placed_ns() is after `scheduled_ns` by more than the protocol's bound
  FrameFacts facts;
};

/// All frames of a trial, plus the closing instant, so that N intervals follow from N frames.
struct PlayedTrial {
  std::vector<FrameRecord> frames;
  std::int64_t end_ns = 0;
  std::optional<std::int64_t> cut;  ///< the trial overran: number of scheduled frames not shown
};

/// Timing bounds of a trial while it is shown.
struct ShowingBounds {
  std::int64_t late_after_ns = 0;  ///< a frame is late if placed_ns() - scheduled exceeds this
  std::int64_t overrun_ns = 0;     ///< a trial is cut if it goes on for longer past its planned end
};

/// Shows one trial. Frame i + 1 is prepared and rendered while frame i is on, then shown at its deadline.
/// Deadlines are absolute: they are counted from the first frame, and a late frame, which is shown at once,
/// moves none of them. No frame and no content step is skipped. The last frame stays on until the end of its
/// interval, or for its whole interval when it came after that end. A frame that is ready only after the
/// overrun is not shown: the trial is cut, and ends once the last one has had its interval. `each` (may be
/// empty) is called after every frame, for the journal. base::Error when there is no interval, one is not
/// positive, or the content ends before start_frame.
PlayedTrial play_trial(const std::vector<std::int64_t>& intervals_ns, const ContentRules& content,
                       Stimulus& stimulus, Display& display, Clock& clock, const ShowingBounds& bounds,
                       const std::function<void(const FrameRecord&)>& each);

/// Shows a trial without a schedule: every frame as soon as it is ready, until `duration_s` have passed since
/// the first; scheduled_ns is the instant at which it was ready, and no frame is late. The last frame stays
/// on until the next one, which is not shown, is ready; if that takes longer than the overrun, the trial
/// counts as cut. base::Error if the clock does not advance meanwhile (VirtualClock) or the content ends
/// before start_frame.
PlayedTrial play_native(double duration_s, const ContentRules& content, Stimulus& stimulus, Display& display,
                        Clock& clock, std::int64_t overrun_ns,
                        const std::function<void(const FrameRecord&)>& each);

/// Tolerances of a protocol.
struct TimingTolerance {
  double late_after_ms = 0.5;
  double mean_relative = 0.005;
  double sd_relative = 0.02;
  double sd_absolute = 0.25;         ///< frames/s; the wider of the two sd bounds applies
  double fail_mean_relative = 0.05;  ///< beyond this the trial has failed, not only degraded
  double fail_sd_relative = 0.20;
  double fail_sd_absolute = 2.5;  ///< frames/s; the wider of the two applies
  /// How long a trial may go on past its planned end before it is cut; none: as long as the trial, at least
  /// 5 s.
  std::optional<double> overrun_s;
};

/// The bounds of a trial of this length.
ShowingBounds showing_bounds(const TimingTolerance& tolerance, double duration_s);

enum class Verdict { Pass, Degraded, Fail };

/// An interval longer than this many median intervals counts as a hitch.
inline constexpr double hitch_factor = 1.5;

/// Nominal and realised timing of a trial, with the grade of the evidence.
struct TimingVerdict {
  Verdict verdict = Verdict::Fail;
  TimingGrade grade = TimingGrade::CpuSubmit;
  FpsSetting nominal;
  stats::FpsMoments realised;
  double longest_ms = 0, shortest_ms = 0, p95_ms = 0, p99_ms = 0;
  std::int64_t hitches = 0;  ///< intervals longer than hitch_factor times the median interval
  /// Mean absolute difference between the content's step and the interval of a frame, ms; none if the content
  /// follows frames instead of time.
  std::optional<double> animation_error_ms;
  double lag1 = 0;  ///< autocorrelation of 1/dt at lag 1; 0 when delta is 0
  std::int64_t late = 0;
  double worst_late_ms = 0;
  bool cut = false;    ///< it overran
  std::string reason;  ///< why the verdict is not pass
};

/// Intervals in seconds between the onsets of successive frames, the last one up to end_ns. Onsets are actual
/// display times if the grade is A or B and every frame has one, else placed_ns().
std::vector<double> realised_intervals(const PlayedTrial& played, TimingGrade grade);

/// pass: no frame late and both realised moments within tolerance. fail: cut, or a moment beyond the fail_
/// bounds. degraded: everything between. The mean is the one that the rules specify. Needs at least one
/// frame; onsets that do not ascend are a fail with that reason.
TimingVerdict judge_trial(const FpsSetting& nominal, const PacingRules& rules, const PlayedTrial& played,
                          const TimingTolerance& tolerance, TimingGrade grade);

/// Timing of a trial without a schedule: realised moments and intervals; the nominal moments are 0. A cut
/// trial is a fail; otherwise `verdict` has no meaning.
TimingVerdict describe_trial(const PlayedTrial& played, TimingGrade grade);

/// "pass", "degraded" or "fail".
std::string verdict_name(Verdict verdict);

}  // namespace study
