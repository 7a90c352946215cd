#pragma once
/// Records gaze and head poses (if the participant allows it) and headset slots during a presentation.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/session/running.hpp"

namespace study {

/// The trial is cut and shown again if the tracker's samples show no eyes for longer than this, ns.
inline constexpr std::int64_t longest_gaze_gap_ns = 100'000'000;

/// A change of the distance between the eyes.
struct IpdChange {
  std::int64_t clock_ns = 0;
  double ipd_mm = 0;
};

struct Recorded {
  std::vector<GazeSample> gaze;
  std::vector<SlotRecord> slots;
  std::vector<IpdChange> ipds{};
};

/// Records one presentation for its lifetime. Checks anew each time whether the participant allows gaze.
class Recording {
 public:
  explicit Recording(const Running& run);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Source of the recorded gaze.
  GazeOrigin origin() const { return gaze_ ? gaze_->origin() : GazeOrigin::Mouse; }
  /// Returns the records since the last call.
  Recorded take();
  /// Throws TrialAgain if the records taken show that an eye tracker lost the eyes for too long.
  void require_gaze() const;

  /// The gaze source that the fluid follows now. A tracker that may not be recorded is not read either: the
  /// head ("head") or the middle of the picture ("fixed") replaces it.
  static std::string followed(const Running& run);

 private:
  void watch(const std::vector<GazeSample>& samples);

  GazeSource* gaze_;
  SlotSource* slots_;
  std::int64_t seen_ns_;  ///< time of the last valid sample
  bool lost_ = false;
  std::optional<double> ipd_mm_;
};

/// True if an eye tracker gives a valid sample within this time; the display is black meanwhile. Also true if
/// no tracker is recorded: there is none, or the participant does not allow it.
bool sees_eyes(const Running& run, double within_s, const Check& check);

/// Stores the headset's facts and the distance between the eyes, e.g. at the start of a session.
void record_headset(const Running& run);

/// Logs the headset's events since the last call. If there were any, stores the headset's current facts.
/// Stores the headset's new events and returns their names, separated by ", ". The text is empty if nothing
/// happened or there is no headset.
std::string log_news(const Running& run);

}  // namespace study
