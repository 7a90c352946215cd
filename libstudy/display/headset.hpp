#pragma once
/// What a session keeps of a headset: what it is, its slots, and where the head was.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// One eye's picture; angles from straight ahead, negative to the left and downwards.
struct EyeFacts {
  int width_px = 0, height_px = 0;
  double left_deg = 0, right_deg = 0, up_deg = 0, down_deg = 0;
  bool operator==(const EyeFacts&) const = default;
};

/// What a headset is and tells.
struct HeadsetFacts {
  std::string runtime, runtime_version, headset;
  std::array<EyeFacts, 2> eyes;  ///< left and right
  std::string format;            ///< of the pictures handed over
  std::optional<double> refresh_told_hz, refresh_measured_hz;
  std::string hold = "image";  ///< "image", "state" or "head_locked": what is seen between two frames
  std::string blend;           ///< environment blend mode: "opaque"
  bool times_convert = false;
  bool position_tracking = false;  ///< the runtime says that it follows the head's place
  bool eye_tracking = false;       ///< an eye tracker was asked for and is served
  bool operator==(const HeadsetFacts&) const = default;
};

/// Where the middle between the eyes is and how it is turned, in the room as the runtime fixed it: x right, y
/// up, z back, m. What is not valid is not known; what is valid and not tracked is a guess.
struct HeadPose {
  std::array<double, 3> place_m{};
  std::array<double, 4> turn{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  bool place_valid = false, turn_valid = false;
  bool place_tracked = false, turn_tracked = false;
};

/// A change of the distance between the eyes that is kept, mm.
inline constexpr double ipd_change_mm = 0.2;

/// A period of the headset's compositor.
struct SlotRecord {
  std::int64_t predicted_ns = 0;  ///< when it is to be seen, on the session's clock
  std::int64_t period_ns = 0;     ///< as the runtime tells it
  bool should_render = false;     ///< false: nothing of it would be seen
  std::optional<HeadPose> head;   ///< none: not asked for
  double ipd_mm = 0;              ///< distance of the eyes' places; 0: not known
};

/// A headset as the session reads it. Calls come from the session's thread.
class SlotSource {
 public:
  virtual ~SlotSource() = default;
  /// As of now.
  virtual HeadsetFacts facts() const = 0;
  /// From here on slots are kept; with_heads: and where the head is, which the participant allows.
  virtual void start_slots(bool with_heads) = 0;
  /// Gives those that are over since start_slots() or the last call, in their order.
  virtual std::vector<SlotRecord> take_slots() = 0;
  virtual void stop_slots() = 0;
  /// Distance of the eyes' places in the newest slot, mm; none: not known.
  virtual std::optional<double> ipd_mm() = 0;
  /// What happened to the headset since the last call, in words for the log: facts() may be others now.
  virtual std::vector<std::string> take_news() = 0;
};

}  // namespace study
