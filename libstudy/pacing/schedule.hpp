#pragma once
/// Schedules: frame intervals with an exact mean and standard deviation of the frame rate, and how exactly a
/// display with a fixed refresh can show them.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/pacing/profile.hpp"
#include "stats/fps_window.hpp"

namespace study {

using stats::FpsMean;
enum class FrameOrder { White, Ar1, Trace };

/// The part of a protocol that determines the list of frame intervals for a setting (mean and standard
/// deviation of the frame rate). The protocol's hash covers these rules.
struct PacingRules {
  FpsMean mean = FpsMean::Harmonic;
  double fps_min = 4;               ///< lowest instantaneous rate, frames/s
  std::optional<double> fps_max;    ///< highest instantaneous rate, frames/s; none: no bound
  bool fps_max_is_refresh = false;  ///< true: the highest rate is the display's refresh rate
  double max_interval_ms = 250;     ///< longest allowed time for which a frame is shown, ms
  FrameOrder order = FrameOrder::White;
  double ar1 = 0;                   ///< requested lag-1 autocorrelation for FrameOrder::Ar1, (-1, 1)
  std::vector<double> trace_rates;  ///< frame rates whose order FrameOrder::Trace copies
};

/// The rules for a display with the fixed refresh refresh_hz (0: none): fps_max_is_refresh is replaced by
/// fps_max = refresh_hz, or by no upper bound if there is no fixed refresh.
PacingRules for_display(PacingRules rules, double refresh_hz);

/// Frame timing of one cell (condition) of the study's design.
struct FpsSetting {
  double mean = 0;  ///< frames/s
  double sd = 0;    ///< standard deviation of the frame rate, frames/s
  double duration_s = 10;
  /// The timing profile, in protocols of format 3; null: none. If it is not of kind Moments, `mean` and `sd`
  /// are those of the profile's intervals before a display rounds them.
  std::shared_ptr<const TimingProfile> profile = {};

  bool operator==(const FpsSetting& other) const;
};

/// The setting of a profile. base::Error if its numbers contradict each other, such as a floor above the
/// mean.
FpsSetting setting_of(const TimingProfile& profile, double duration_s);
/// True if the intervals come from a pattern (hitches, a floor or a trace of the profile) instead of a mean
/// and a standard deviation.
bool has_pattern(const FpsSetting& setting);
/// Name of the setting in messages and tables: profile_text() of its profile or, without a profile, mean and
/// standard deviation, such as "(50, 20)".
std::string setting_name(const FpsSetting& setting);
/// The number of frames of a trial, N = round(mean * duration), at least 1.
std::int64_t frame_count(const FpsSetting& setting);

/// A schedule. Interval i is the time for which frame i is shown. If compile_schedule() makes it from a mean
/// and a standard deviation, the relative errors of both are at most 1e-9 in intervals_s and at most 1e-6 in
/// intervals_ns. If the standard deviation is below 1 frame/s, its error in intervals_ns is at most 1e-6
/// frames/s.
struct Schedule {
  std::vector<double> intervals_s;
  std::vector<std::int64_t> intervals_ns;  ///< whole nanoseconds
};

/// Makes the schedule of a setting for a display without a fixed refresh. Its N = round(mean * duration)
/// frame rates are stratified quantiles of a truncated normal, whose parameters are solved so that the list
/// has exactly the requested mean and sd. `seed` and the rules determine their order. base::Error naming the
/// setting if there is no solution. For a setting with a pattern, the schedule has the pattern's intervals,
/// and the rules are not applied.
Schedule compile_schedule(const FpsSetting& setting, const PacingRules& rules, std::uint64_t seed);

enum class Feasibility { Exact, Approximate, Unreachable };

/// Result of quantise(): how well a display with a fixed refresh can show a setting.
struct RefreshVerdict {
  Feasibility feasibility = Feasibility::Unreachable;
  std::int64_t frames = 0;  ///< number N of frames
  double mean = 0;          ///< of the best holds found, frames/s; harmonic for a pattern, else as rules.mean
  double sd = 0;            ///< of the best holds found, frames/s
  /// 2-Wasserstein distance to the unquantised rates, frames/s; for a pattern, the root mean square change of
  /// the frames' rates.
  double distance = 0;
  int longest_hold = 0;  ///< longest hold, refresh periods
  /// Number of refresh periods for each frame, in display order; empty if unreachable.
  std::vector<int> holds;
  std::string reason;  ///< why `feasibility` is not Exact
};

/// Finds the holds (whole numbers of refresh periods) of N = round(mean * duration) frames on a display with
/// the fixed refresh R = refresh_hz > 0.
///
/// exact: the holds sum to exactly R N / mean periods, and the sd is within max(2 %, 0.25 frames/s). No hold
/// exceeds max_interval_ms, 1 / fps_min or the longest interval of exact_rates() (the frame rates without a
/// fixed refresh) rounded up to a period, and no rate exceeds fps_max. An arithmetic mean need only be within
/// 0.01 %, because sums of R / k seldom equal a given number. approximate: the mean is within 0.5 %, the sd
/// is as near as the search comes, and the same bounds on holds apply. unreachable: neither, or exact_rates()
/// fails. Among lists that meet mean and sd, the search aims at the list nearest to exact_rates()
/// (hold_search.hpp). With fps_max_is_refresh, fps_max is R.
///
/// With a pattern, each deadline moves to the nearest period, but to at least one period after the deadline
/// before; the rules are not applied. exact: no interval changed by more than 1 % of itself. approximate: the
/// mean changed by at most 0.5 %. unreachable: otherwise.
RefreshVerdict quantise(const FpsSetting& setting, const PacingRules& rules, double refresh_hz,
                        std::uint64_t seed);

/// The schedule of a list of holds, in refresh periods.
Schedule schedule_of_holds(const std::vector<int>& holds, double refresh_hz);

/// "exact", "approximate" or "unreachable".
std::string feasibility_name(Feasibility feasibility);

}  // namespace study
