#pragma once
/// What is recorded beside the frames of a presentation: gaze and head of who allows it, slots of a headset.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/session/running.hpp"

namespace study {

/// An eye tracker that loses the eyes for longer than this spoils what they see, ns.
inline constexpr std::int64_t longest_gaze_gap_ns = 100'000'000;

/// A distance between the eyes that another one was before.
struct IpdChange {
  std::int64_t clock_ns = 0;
  double ipd_mm = 0;
};

struct Recorded {
  std::vector<GazeSample> gaze;
  std::vector<SlotRecord> slots;
  std::vector<IpdChange> ipds{};
};

/// The recording of one presentation, while it lives. Whether the participant allows gaze is asked anew each
/// time.
class Recording {
 public:
  explicit Recording(const Running& run);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Of the gaze that is recorded.
  GazeOrigin origin() const { return gaze_ ? gaze_->origin() : GazeOrigin::Mouse; }
  /// What came since the last call.
  Recorded take();
  /// Throws TrialAgain when what was taken shows that an eye tracker lost the eyes for too long.
  void require_gaze() const;

  /// What the fluid follows in this session now: the head, or the middle of the picture, stands in for a
  /// tracker whose gaze may not be recorded, for then it is not read either.
  static std::string followed(const Running& run);

 private:
  void watch(const std::vector<GazeSample>& samples);

  const Running& run_;
  GazeSource* gaze_;
  SlotSource* slots_;
  std::int64_t seen_ns_;  ///< the last sample that was valid
  bool lost_ = false;
  std::optional<double> ipd_mm_;
};

/// Whether an eye tracker gives a valid sample within this time; the display is black meanwhile. Also true
/// where no tracker is recorded: there is none, or the participant does not allow it.
bool sees_eyes(const Running& run, double within_s, const Check& check);

/// At the start of a session: what the headset is, and the distance between the eyes.
void record_headset(const Running& run);

/// Logs what happened to the headset since the last call, and keeps what it is now; what was logged, with
/// commas between.
std::string log_news(const Running& run);

}  // namespace study
