#pragma once
/// FPS schedules with exact moments, and their feasibility on a display with a fixed refresh.

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

/// The part of a protocol that fixes how a setting (mu, delta) becomes a list of intervals. Hashed and stored
/// per trial.
struct PacingRules {
  FpsMean mean = FpsMean::Harmonic;
  double fps_min = 4;               ///< lowest instantaneous rate, frames/s
  std::optional<double> fps_max;    ///< highest, frames/s; none = no upper bound
  bool fps_max_is_refresh = false;  ///< the upper bound is the display's refresh; see for_display()
  double max_interval_ms = 250;     ///< longest interval allowed
  FrameOrder order = FrameOrder::White;
  double ar1 = 0;                   ///< lag-1 correlation wanted with FrameOrder::Ar1, in (-1, 1)
  std::vector<double> trace_rates;  ///< order pattern with FrameOrder::Trace
};

/// The rules on a display of this fixed refresh (0 = none): the bound "refresh" becomes a number, or no upper
/// bound without a fixed refresh.
PacingRules for_display(PacingRules rules, double refresh_hz);

/// Timing of one cell of the design.
struct FpsSetting {
  double mean = 0;  ///< frames/s
  double sd = 0;    ///< standard deviation of the frame rate, frames/s
  double duration_s = 10;
  /// Format 3. If it is not of kind Moments, `mean` and `sd` are those of its intervals before a display
  /// rounds them.
  std::shared_ptr<const TimingProfile> profile = {};

  bool operator==(const FpsSetting& other) const;
};

/// The setting of a profile. base::Error if its numbers contradict each other, such as a floor above the
/// mean.
FpsSetting setting_of(const TimingProfile& profile, double duration_s);
/// True if the intervals come from a pattern instead of a mean and a standard deviation.
bool has_pattern(const FpsSetting& setting);
/// The setting as messages and tables name it, e.g. "(50, 20)", or profile_text().
std::string setting_name(const FpsSetting& setting);
/// N = round(mean * duration), at least 1.
std::int64_t frame_count(const FpsSetting& setting);

/// A finished schedule. Interval i is the time that frame i stays on.
struct Schedule {
  std::vector<double> intervals_s;         ///< meets both moments to 1e-9
  std::vector<std::int64_t> intervals_ns;  ///< whole nanoseconds, meets them to 1e-6
};

/// N = round(mean * duration) stratified quantiles of a truncated normal in FPS whose parameters are solved
/// so that the list has the requested moments exactly, ordered by `seed`. base::Error naming the setting when
/// there is no solution. With a pattern: its intervals, without any rule.
Schedule compile_schedule(const FpsSetting& setting, const PacingRules& rules, std::uint64_t seed);

enum class Feasibility { Exact, Approximate, Unreachable };

/// How well a fixed refresh reproduces a setting.
struct RefreshVerdict {
  Feasibility feasibility = Feasibility::Unreachable;
  std::int64_t frames = 0;  ///< N
  double mean = 0;          ///< best found, frames/s; harmonic or arithmetic by the rules
  double sd = 0;            ///< frames/s
  double distance = 0;      ///< 2-Wasserstein distance to the unquantised rates, frames/s
  int longest_hold = 0;     ///< periods
  /// Periods each frame is held, in the order of `seed`; empty when unreachable.
  std::vector<int> holds;
  std::string reason;  ///< why it is not Exact
};

/// exact: some N = round(mean * duration) hold counts whose sum is exactly R N / mean periods (R T where mean
/// * duration is whole), with delta within max(2 %, 0.25 frames/s) and no hold longer than the unquantised
/// schedule's longest interval rounded up to a period, nor than max_interval_ms. approximate: mu within 0.5
/// %, delta as near as possible, same bound on the holds. unreachable: neither, or no unquantised schedule.
/// Of the lists that meet the moments, the one nearest to the unquantised rates is searched
/// (hold_search.hpp). With the arithmetic mean, sums of R / k seldom hit a number exactly: there mu counts as
/// met within 0.01 %. refresh_hz > 0. Applies rules.fps_max_is_refresh.
/// With a pattern, each deadline moves to the nearest period, at least one after the last, without any rule.
/// exact: no interval moved by more than 1 % of itself. approximate: the mean moved by at most 0.5 %.
RefreshVerdict quantise(const FpsSetting& setting, const PacingRules& rules, double refresh_hz,
                        std::uint64_t seed);

/// The schedule of a list of holds.
Schedule schedule_of_holds(const std::vector<int>& holds, double refresh_hz);

/// "exact", "approximate" or "unreachable".
std::string feasibility_name(Feasibility feasibility);

}  // namespace study
