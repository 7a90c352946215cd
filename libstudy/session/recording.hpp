#pragma once
/// Records a presentation: the headset's slots (SlotRecord: one display period), and gaze and head poses if
/// the participant allows gaze recording.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/session/running.hpp"

namespace study {

/// An invalid sample of the eye tracker more than this time after the last valid sample cuts the trial, which
/// is then shown again, ns. So does an eye tracker that sends no sample for more than this time.
inline constexpr std::int64_t longest_gaze_gap_ns = 100'000'000;

/// A change of the interpupillary distance (IPD).
struct IpdChange {
  std::int64_t clock_ns = 0;
  double ipd_mm = 0;
};

struct Recorded {
  std::vector<GazeSample> gaze;
  std::vector<SlotRecord> slots;
  std::vector<IpdChange> ipds{};
};

/// Records one presentation from construction to destruction. The constructor reads from the store whether
/// the participant allows gaze recording.
class Recording {
 public:
  explicit Recording(const Running& run);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// The kind of the recorded gaze's source; Mouse if no gaze is recorded.
  GazeOrigin origin() const { return gaze_ ? gaze_->origin() : GazeOrigin::Mouse; }
  /// Returns the gaze samples, frame slots and changes of the IPD that were recorded since the last call.
  Recorded take();
  /// Throws TrialAgain if take() returned an invalid sample of the eye tracker that came more than
  /// longest_gaze_gap_ns after the last valid sample (or after the start of the recording), or if take()
  /// returned no sample of the eye tracker for more than longest_gaze_gap_ns.
  void require_gaze() const;

  /// Name of the gaze source that the fluid follows now. An eye tracker without permission to record is not
  /// read: the fluid then follows the head in a headset ("head"), else the middle of the picture ("fixed").
  static std::string followed(const Running& run);

 private:
  void watch(const std::vector<GazeSample>& samples);

  const Running& run_;
  GazeSource* gaze_;
  SlotSource* slots_;
  std::int64_t seen_ns_;   ///< time of the last valid sample
  std::int64_t heard_ns_;  ///< time of the last take() that returned a sample
  bool lost_ = false;
  std::optional<double> ipd_mm_;
};

/// True once the condition is true; false if it is not within `within_s`. The display is black meanwhile.
bool comes_true(const Running& run, const std::function<bool()>& condition, double within_s,
                const Check& check);

/// True if an eye tracker gives a valid sample within `within_s`; the display is black meanwhile. Also true
/// without an eye tracker, and if the participant does not allow recording.
bool sees_eyes(const Running& run, double within_s, const Check& check);

/// Stores the headset's facts and the interpupillary distance. Does nothing without a headset.
void record_headset(const Running& run);

/// Stores the newest clock offset of the gaze source, if it has a clock of its own. Call it when a session
/// begins.
void record_tracker(const Running& run);

/// Logs the gaze source's events, and stores its clock offsets, since the last call. Writes only if there are
/// any.
void log_tracker(const Running& run);

/// Logs the headset's events since the last call and returns their names, separated by ", ". Also stores the
/// headset's facts for each refresh rate and session since then. Returns an empty text without events or
/// without a headset.
std::string log_news(const Running& run);

}  // namespace study
