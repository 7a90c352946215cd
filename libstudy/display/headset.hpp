#pragma once
/// What a session records about a headset: its properties, its slots (display periods of the headset's
/// compositor) and the poses of the head.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// Size and edges of one eye's picture; angles from straight ahead, negative to the left and downwards.
struct EyeFacts {
  int width_px = 0, height_px = 0;
  double left_deg = 0, right_deg = 0, up_deg = 0, down_deg = 0;
  bool operator==(const EyeFacts&) const = default;
};

/// Properties that a headset and its OpenXR runtime report.
struct HeadsetFacts {
  std::string runtime, runtime_version, headset;
  std::array<EyeFacts, 2> eyes;  ///< left and right
  std::string format;            ///< pixel format of the submitted pictures
  /// Refresh rate that the runtime reports, and the measured rate, Hz; none: not known.
  std::optional<double> refresh_told_hz, refresh_measured_hz;
  /// How a picture that is shown for several periods follows the head: "image" (the runtime reprojects the
  /// picture), "state" (the frozen fluid is redrawn) or "head_locked" (the picture moves with the head).
  std::string hold = "image";
  std::string blend;               ///< environment blend mode: "opaque"
  bool times_convert = false;      ///< the runtime's times convert to the session's clock
  bool position_tracking = false;  ///< the runtime reports that it tracks the head's position
  bool eye_tracking = false;       ///< an eye tracker was requested and is available
  bool operator==(const HeadsetFacts&) const = default;
};

/// Position (m) and orientation of the midpoint of the eyes in the runtime's room frame: x right, y up, z
/// back. A position or orientation that is not valid is unknown. A valid position or orientation that is not
/// tracked is an estimate of the runtime.
struct HeadPose {
  std::array<double, 3> place_m{};
  std::array<double, 4> turn{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  bool place_valid = false, turn_valid = false;
  bool place_tracked = false, turn_tracked = false;
};

/// The distance between the eyes is recorded again once it has changed by more than this, mm.
inline constexpr double ipd_change_mm = 0.2;

/// A slot: one display period of the headset's compositor.
struct SlotRecord {
  std::int64_t predicted_ns = 0;  ///< predicted display time, on the session's clock
  std::int64_t period_ns = 0;     ///< period as the runtime reports it
  bool should_render = false;     ///< false: a picture would not be visible
  std::optional<HeadPose> head;   ///< pose of the head; none: not requested
  double ipd_mm = 0;              ///< distance between the eyes; 0: not known
};

/// Interface through which a session records a headset. Calls come from the session's thread.
class SlotSource {
 public:
  virtual ~SlotSource() = default;
  /// The current properties.
  virtual HeadsetFacts facts() const = 0;
  /// Begins to record slots. with_heads: also records the head's pose; needs the participant's consent.
  virtual void start_slots(bool with_heads) = 0;
  /// Returns the slots that ended since start_slots() or the last take_slots(), in order of time.
  virtual std::vector<SlotRecord> take_slots() = 0;
  virtual void stop_slots() = 0;
  /// Distance between the eyes in the newest slot, mm; none: not known.
  virtual std::optional<double> ipd_mm() = 0;
  /// Events of the headset since the last call, in words for the log.
  virtual std::vector<std::string> take_news() = 0;
  /// Properties since the last call, in order: one entry for each refresh rate that came into force and for
  /// each new session. The measured rate is missing where the rate changed again at once.
  virtual std::vector<HeadsetFacts> take_facts() { return {}; }
};

}  // namespace study
