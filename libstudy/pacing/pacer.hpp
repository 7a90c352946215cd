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

/// How content advances. real_time = false (per_frame, the paper's interpretation): frame i shows content
/// step start_frame + i. real_time = true: frame i shows the content step of its scheduled time. Without a
/// schedule, the time at which the program began to make the frame replaces the scheduled time. Times count
/// from the first frame. At its end, a process of finite length goes back to start_frame (Loop) or stays at
/// its last step (Hold).
struct ContentRules {
  bool real_time = false;
  double content_step_s = 1.0 / 60;
  std::int64_t start_frame = 0;
  AtEnd at_end = AtEnd::Loop;
  double latency_s = 0;  ///< real_time: the content lags behind the time of its frame by this, s
  /// real_time: the content's step between two frames differs from the frame's interval by this, alternately
  /// more and less, s. Content never runs backwards: where the error exceeds the interval, the content stands
  /// still.
  double animation_error_s = 0;
};

/// Returns `rules` with the latency and the animation error of the setting's profile, if it has a profile.
ContentRules content_of(ContentRules rules, const FpsSetting& setting);

/// One shown frame. Times are nanoseconds on the session's clock; -1 = not known.
struct FrameRecord {
  std::int64_t index = 0;
  std::int64_t content_step = 0;
  std::int64_t scheduled_ns = 0;
  PresentTimes times;
  /// True: the frame came after scheduled_ns by more than the protocol's bound. The frame's time is
  /// placed_ns(): its predicted display time under grade C (Compositor), else the time of its submission.
  bool late = false;
  FrameFacts facts;
};

/// All frames of a trial, and the end of the last frame, so that N frames have N intervals.
struct PlayedTrial {
  std::vector<FrameRecord> frames;
  std::int64_t end_ns = 0;
  /// Set if the trial overran and was cut: the number of frames not shown; 0 without a schedule.
  std::optional<std::int64_t> cut;
};

/// Timing bounds of a trial while it is shown.
struct ShowingBounds {
  std::int64_t late_after_ns = 0;  ///< a frame that comes more than this after scheduled_ns is late
  std::int64_t overrun_ns = 0;     ///< a frame ready later than this after the planned end cuts the trial
};

/// Shows one trial. Frame i + 1 is prepared and rendered while frame i is on, then shown at its deadline.
/// Deadlines are absolute: they count from the first frame. A late frame is shown at once and moves no
/// deadline. No frame is skipped to catch up. The last frame stays on until the planned end of the trial; if
/// it came after the planned end, it stays on for its whole interval. A frame that is ready later than
/// overrun_ns after the planned end is not shown: the trial is cut, and ends when the interval of the frame
/// before is over. `each` (may be empty) is called after every shown frame. base::Error if there is no
/// interval, if an interval is not positive, or if the content ends before start_frame.
PlayedTrial play_trial(const std::vector<std::int64_t>& intervals_ns, const ContentRules& content,
                       Stimulus& stimulus, Display& display, Clock& clock, const ShowingBounds& bounds,
                       const std::function<void(const FrameRecord&)>& each);

/// Shows a trial without a schedule: every frame as soon as it is ready, until `duration_s` have passed since
/// the first frame. scheduled_ns is the instant at which a frame was ready; no frame is late. The last frame
/// stays on until one more frame is ready, which is not shown. If that is more than overrun_ns after
/// `duration_s`, the trial counts as cut. base::Error if the clock does not advance while a frame is made
/// (VirtualClock), or if the content ends before start_frame.
PlayedTrial play_native(double duration_s, const ContentRules& content, Stimulus& stimulus, Display& display,
                        Clock& clock, std::int64_t overrun_ns,
                        const std::function<void(const FrameRecord&)>& each);

/// A protocol's tolerances for the timing of a trial. Members with `relative` in their names are fractions of
/// the nominal mean or standard deviation.
struct TimingTolerance {
  double late_after_ms = 0.5;
  double mean_relative = 0.005;
  double sd_relative = 0.02;
  double sd_absolute = 0.25;         ///< frames/s; the wider of the two sd_ bounds applies
  double fail_mean_relative = 0.05;  ///< a larger error of the mean fails the trial
  double fail_sd_relative = 0.20;
  double fail_sd_absolute = 2.5;  ///< frames/s; the wider of the two fail_sd_ bounds applies
  /// Time past its planned end after which a trial is cut, s; none: the planned duration, but at least 5 s.
  std::optional<double> overrun_s;
};

/// The bounds of a trial with the planned duration duration_s.
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
  double lag1 = 0;  ///< lag-1 autocorrelation of the realised rates
  std::int64_t late = 0;
  double worst_late_ms = 0;
  bool cut = false;    ///< true: cut, because the trial overran
  std::string reason;  ///< why the verdict is not pass
};

/// Intervals in seconds between the onsets of successive frames; the last interval ends at end_ns. Onsets are
/// the actual display times if the grade is A (photodiode) or B (display feedback) and every frame has an
/// actual display time. Otherwise they are placed_ns(): under grade C (compositor) the predicted display
/// times, else the times of submission.
std::vector<double> realised_intervals(const PlayedTrial& played, TimingGrade grade);

/// pass: no frame is late, and mean and standard deviation are within tolerance. fail: the trial was cut, a
/// moment is beyond its fail_ bound, or onsets do not ascend. degraded: otherwise. The mean is harmonic or
/// arithmetic, as the rules specify. base::Error if no frame was shown.
TimingVerdict judge_trial(const FpsSetting& nominal, const PacingRules& rules, const PlayedTrial& played,
                          const TimingTolerance& tolerance, TimingGrade grade);

/// Timing of a trial without a schedule: realised moments and intervals; the nominal moments are 0. The
/// verdict is fail for a cut trial and pass for any other, whatever its timing. base::Error if no frame was
/// shown.
TimingVerdict describe_trial(const PlayedTrial& played, TimingGrade grade);

/// "pass", "degraded" or "fail".
std::string verdict_name(Verdict verdict);

}  // namespace study
