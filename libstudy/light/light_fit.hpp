#pragma once
/// Light edges of a sensor against the frame onsets of the record: the clocks' offset and drift, and what
/// each showing of a stimulus did on the display.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/display/stimulus.hpp"
#include "libstudy/light/light_edges.hpp"

namespace study {

/// A showing of a stimulus with the light patch: its first frame is bright, the next dark, and so on.
struct RecordedShowing {
  std::int64_t presentation = 0;        ///< its row in the database
  std::vector<std::int64_t> onsets_ns;  ///< of its frames, by the record's own evidence, ascending
};

/// What the sensor saw of a showing.
struct ShowingLight {
  std::int64_t presentation = 0;
  std::int64_t frames = 0, matched = 0;  ///< recorded onsets, and those with a light edge
  std::vector<std::int64_t> missed;      ///< indices of frames whose brightness was never seen
  /// Frames that were seen and whose onset has no edge, because the frame before was missed.
  std::int64_t hidden = 0;
  std::int64_t extra = 0;  ///< edges within the showing that belong to no onset
  /// Mean time from a recorded onset to its light, without outliers. Absolute if LightFit::absolute, else
  /// relative to the median showing.
  double lag_ms = 0;
  double jitter_ms = 0;  ///< standard deviation of that time over the showing's matched onsets
  double worst_ms = 0;   ///< largest deviation of an onset from lag_ms
  /// Why the log cannot judge this showing, such as a gap in it; empty: it can.
  std::string unjudged;
};

struct LightFit {
  double drift_ppm = 0;       ///< how much faster the sensor's clock runs than the record's
  double fall_shift_ms = 0;   ///< dark onsets are seen this much later than bright ones
  bool absolute = false;      ///< lags are times from onset to light; false: relative to the median showing
  std::int64_t triggers = 0;  ///< markers that were found on the trigger line
  std::vector<ShowingLight> showings;  ///< in the order of the record
  std::int64_t judged = 0;             ///< number of showings without `unjudged`
};

/// Aligns a log with the showings of one stretch of a session, in which the record's clock did not change.
///
/// Method: the first onsets of a showing vote for the offset, over drifts up to 0.5 %; from there the fit is
/// extended to the other showings. The line is fitted robustly (Tukey's biweight) to all onsets, with an own
/// constant for dark ones. Edges belong to the nearest onset of their direction. Missed frames, edges too
/// many, and a log that begins or ends in mid-session do not matter for it.
///
/// triggers: rising edges of the trigger line. markers_ns: when markers left the computer, on the record's
/// clock. If most markers within the log have a trigger at one common distance, lags are absolute.
///
/// None if no showing fits, or fewer than half of those that would lie in the log; `why` says so in words.
std::optional<LightFit> fit_light(const SensorLog& log, std::span<const LightEdge> edges,
                                  std::span<const RecordedShowing> showings,
                                  std::span<const LightEdge> triggers,
                                  std::span<const std::int64_t> markers_ns, std::string& why);

/// Bounds of a grade: each recorded onset has its light, none is missed, hidden or too many, and the sampling
/// interval, jitter and worst deviation are at most these.
struct LightBounds {
  TimingGrade grade;
  double interval_ms, jitter_ms, worst_ms;
};
/// A: 2 ms are less than half a period of 240 Hz, so that no onset was in another refresh. B: 8 ms are less
/// than half a period of 60 Hz.
inline constexpr LightBounds light_bounds[] = {{TimingGrade::Photodiode, 1.1, 1, 2},
                                               {TimingGrade::DisplayFeedback, 4.1, 4, 8}};
inline constexpr std::int64_t least_graded_frames = 10;

/// The grade that the light of a showing earns; none: `why` says in words what is missing for B.
std::optional<TimingGrade> light_grade(const ShowingLight& light, double interval_s, std::string& why);

}  // namespace study
