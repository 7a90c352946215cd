#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libstudy/pacing/frame_order.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "stats/base/error.hpp"
#include "stats/quantiles.hpp"

namespace study {

namespace {

constexpr double ms = 1e-6;  // nanoseconds to milliseconds
constexpr double least_overrun_s = 5;

bool has_display_times(const PlayedTrial& played, TimingGrade grade) {
  return (grade == TimingGrade::Photodiode || grade == TimingGrade::DisplayFeedback) &&
         std::all_of(played.frames.begin(), played.frames.end(),
                     [](const FrameRecord& frame) { return frame.times.actual_display_ns >= 0; });
}

/// Collects the reasons and stores the worst verdict.
class Judgement {
 public:
  void add(Verdict verdict, const std::string& reason) {
    verdict_ = std::max(verdict_, verdict);
    reason_ += (reason_.empty() ? "" : "; ") + reason;
  }
  Verdict verdict() const { return verdict_; }
  const std::string& reason() const { return reason_; }

 private:
  Verdict verdict_ = Verdict::Pass;
  std::string reason_;
};

void judge_moments(Judgement& judgement, const TimingVerdict& trial, double mean,
                   const TimingTolerance& tolerance) {
  const double mean_error = std::abs(mean / trial.nominal.mean - 1);
  if (mean_error > tolerance.mean_relative) {
    judgement.add(mean_error > tolerance.fail_mean_relative ? Verdict::Fail : Verdict::Degraded,
                  fmt::format("mean {:.4g} frames/s is off by {:.2g} %", mean, 100 * mean_error));
  }
  const double sd = trial.nominal.sd;
  const double sd_error = std::abs(trial.realised.sd - sd);
  if (sd_error > std::max(tolerance.sd_relative * sd, tolerance.sd_absolute)) {
    const bool fail = sd_error > std::max(tolerance.fail_sd_relative * sd, tolerance.fail_sd_absolute);
    judgement.add(fail ? Verdict::Fail : Verdict::Degraded,
                  fmt::format("sd {:.4g} frames/s is off by {:.2g}", trial.realised.sd, sd_error));
  }
}

void judge_lateness(Judgement& judgement, TimingVerdict& trial, const PlayedTrial& played,
                    const TimingTolerance& tolerance) {
  for (const auto& frame : played.frames) {
    const double late_ms = ms * static_cast<double>(placed_ns(frame.times, trial.grade) - frame.scheduled_ns);
    trial.worst_late_ms = std::max(trial.worst_late_ms, late_ms);
    trial.late += late_ms > tolerance.late_after_ms;
  }
  if (trial.late > 0) {
    judgement.add(Verdict::Degraded, std::to_string(trial.late) + " late frame" +
                                         (trial.late > 1 ? "s" : "") +
                                         fmt::format(", the worst by {:.3g} ms (bound {:.3g} ms)",
                                                     trial.worst_late_ms, tolerance.late_after_ms));
  }
}

void describe_intervals(TimingVerdict& trial, const std::vector<double>& intervals_s) {
  std::vector<double> sorted = intervals_s;
  std::sort(sorted.begin(), sorted.end());
  trial.shortest_ms = 1000 * sorted.front();
  trial.longest_ms = 1000 * sorted.back();
  trial.p95_ms = 1000 * stats::sorted_quantile(sorted, 0.95);
  trial.p99_ms = 1000 * stats::sorted_quantile(sorted, 0.99);
  const double hitch_s = hitch_factor * stats::sorted_quantile(sorted, 0.5);
  trial.hitches = std::count_if(sorted.begin(), sorted.end(), [&](double dt) { return dt > hitch_s; });
  std::vector<double> rates;
  for (const double dt : intervals_s) rates.push_back(1 / dt);
  trial.lag1 = lag1(rates);
}

void judge_cut(Judgement& judgement, TimingVerdict& trial, const PlayedTrial& played) {
  if (!played.cut) return;
  trial.cut = true;
  const auto shown = static_cast<std::int64_t>(played.frames.size());
  const double after_s = 1e-9 * static_cast<double>(played.end_ns - played.frames.front().scheduled_ns);
  std::string reason = fmt::format("cut {:.3g} s after its start", after_s);
  if (*played.cut > 0)
    reason += ": " + std::to_string(shown) + " of " + std::to_string(shown + *played.cut) + " frames shown";
  judgement.add(Verdict::Fail, reason);
}

/// Measures the realised moments and intervals. Returns false if the onsets do not ascend.
bool measure(TimingVerdict& trial, const PlayedTrial& played) {
  const auto intervals_s = realised_intervals(played, trial.grade);
  if (*std::min_element(intervals_s.begin(), intervals_s.end()) <= 0) return false;
  trial.realised = stats::fps_moments(intervals_s);
  describe_intervals(trial, intervals_s);
  return true;
}

TimingVerdict blank_verdict(const FpsSetting& nominal, const PlayedTrial& played, TimingGrade grade) {
  if (played.frames.empty())
    throw base::Error("trial " + setting_name(nominal), "no frame was shown, so there is no timing to judge",
                      "show the trial again");
  TimingVerdict trial;
  trial.grade = grade;
  trial.nominal = nominal;
  return trial;
}

}  // namespace

ShowingBounds showing_bounds(const TimingTolerance& tolerance, double duration_s) {
  return {std::llround(1e6 * tolerance.late_after_ms),
          std::llround(1e9 * tolerance.overrun_s.value_or(std::max(duration_s, least_overrun_s)))};
}

std::vector<double> realised_intervals(const PlayedTrial& played, TimingGrade grade) {
  const bool shown = has_display_times(played, grade);
  const auto onset = [&](const FrameRecord& frame) {
    return shown ? frame.times.actual_display_ns : placed_ns(frame.times, grade);
  };
  std::vector<double> intervals_s;
  for (std::size_t i = 0; i < played.frames.size(); ++i) {
    const std::int64_t until = i + 1 < played.frames.size() ? onset(played.frames[i + 1]) : played.end_ns;
    intervals_s.push_back(1e-9 * static_cast<double>(until - onset(played.frames[i])));
  }
  return intervals_s;
}

TimingVerdict judge_trial(const FpsSetting& nominal, const PacingRules& rules, const PlayedTrial& played,
                          const TimingTolerance& tolerance, TimingGrade grade) {
  TimingVerdict trial = blank_verdict(nominal, played, grade);
  Judgement judgement;
  judge_cut(judgement, trial, played);
  judge_lateness(judgement, trial, played, tolerance);
  if (measure(trial, played)) {
    const double mean =
        rules.mean == FpsMean::Harmonic ? trial.realised.mean : trial.realised.mean_arithmetic;
    judge_moments(judgement, trial, mean, tolerance);
  } else {
    judgement.add(Verdict::Fail, "the onsets do not ascend");
  }
  trial.verdict = judgement.verdict();
  trial.reason = judgement.reason();
  return trial;
}

TimingVerdict describe_trial(const PlayedTrial& played, TimingGrade grade) {
  TimingVerdict trial = blank_verdict({0, 0, 0}, played, grade);
  Judgement judgement;
  judge_cut(judgement, trial, played);
  trial.verdict = judgement.verdict();
  trial.reason = measure(trial, played) ? judgement.reason() : "the onsets do not ascend";
  return trial;
}

std::string verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::Pass:
      return "pass";
    case Verdict::Degraded:
      return "degraded";
    case Verdict::Fail:
      break;
  }
  return "fail";
}

}  // namespace study
