#pragma once
/// FPS schedules with exact moments, and their certificate on a display with a fixed refresh (study.md
/// section 1).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

enum class FpsMean { Harmonic, Arithmetic };
enum class FrameOrder { White, Ar1, Trace };

/// The part of a protocol that fixes how a setting (mu, delta) becomes a list of intervals. Hashed and stored
/// per trial.
struct PacingRules {
  FpsMean mean = FpsMean::Harmonic;
  double fps_min = 4;               ///< lowest instantaneous rate, frames/s
  std::optional<double> fps_max;    ///< highest, frames/s; none = no upper cut
  bool fps_max_is_refresh = false;  ///< the upper cut is the display's refresh; see for_display()
  double max_interval_ms = 250;     ///< longest interval allowed
  FrameOrder order = FrameOrder::White;
  double ar1 = 0;                   ///< lag-1 correlation wanted with FrameOrder::Ar1, in (-1, 1)
  std::vector<double> trace_rates;  ///< order pattern with FrameOrder::Trace
};

/// The rules on a display of this fixed refresh (0 = frames are shown as they come): "refresh" becomes a
/// number, or no upper cut where there is no fixed refresh.
PacingRules for_display(PacingRules rules, double refresh_hz);

/// One cell of the design: mean and standard deviation of the frame rate, frames/s, and the trial's length.
struct FpsSetting {
  double mean = 0;
  double sd = 0;
  double duration_s = 10;
};

/// The setting as messages and tables name it, e.g. "(50, 20)".
std::string setting_name(const FpsSetting& setting);
/// N = round(mean * duration), at least 1.
std::int64_t frame_count(const FpsSetting& setting);

/// A finished schedule. Interval i is the time that frame i stays on.
struct Schedule {
  std::vector<double> intervals_s;         ///< meets both moments to 1e-9
  std::vector<std::int64_t> intervals_ns;  ///< whole nanoseconds, meets them to 1e-6
};

/// N = round(mean * duration) stratified quantiles of a truncated normal in FPS whose parameters are solved
/// so that the list has the wished moments exactly, ordered by `seed`. base::Error naming the setting when
/// there is no solution.
Schedule compile_schedule(const FpsSetting& setting, const PacingRules& rules, std::uint64_t seed);

enum class Feasibility { Exact, Approximate, Unreachable };

/// What a fixed refresh makes of a setting.
struct RefreshVerdict {
  Feasibility feasibility = Feasibility::Unreachable;
  double mean = 0;  ///< best reachable, frames/s (harmonic)
  double sd = 0;
  int longest_hold = 0;  ///< periods
  std::vector<int>
      holds;  ///< periods each frame is held, compiled for the least distance to the target distribution
  std::string reason;  ///< why it is not exact
};

/// exact: N = round(10 mu) hold counts with sum R T meet mu, and delta within max(2 %, 0.25), no hold longer
/// than the unquantised schedule's longest interval rounded up; approximate: mu within 0.5 %, nearest delta,
/// same bound.
RefreshVerdict quantise(const FpsSetting& setting, const PacingRules& rules, double refresh_hz,
                        std::uint64_t seed);

}  // namespace study
