#pragma once
/// Interface through which an eye tracker, a headset or the mouse sends a session the participant's gaze.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace study {

/// The device that measures the samples. Mouse and head only approximate the gaze: people often look
/// elsewhere than they point.
enum class GazeOrigin { Tracker, Head, Mouse };

/// A point of the picture: fractions of its width from the left edge and of its height from the top edge.
using GazePoint = std::pair<double, double>;

/// The combined (cyclopean) gaze ray of both eyes in the head's frame: x right, y up, z back. The frame's
/// origin is the midpoint of the eyes. HeadPose (headset.hpp) transforms the ray to the room.
struct GazeRay {
  std::array<double, 3> origin_m{};
  std::array<double, 3> direction{0, 0, -1};  ///< unit vector
};

struct GazeSample {
  std::int64_t sampled_ns = 0;            ///< time of the sample, on the session's clock
  std::optional<std::int64_t> device_ns;  ///< time stamp of the device; none: not reported
  bool valid = false;                     ///< false e.g. in a blink or with the pointer off the picture
  std::optional<GazePoint> point;         ///< none: not known; may lie outside the picture
  std::optional<bool> tracked{};          ///< false: estimated by the source; none: not reported
  std::optional<GazeRay> ray{};           ///< none: not valid, or the source has no rays
};

/// A measured offset of the clock of an eye tracker outside the headset's software.
struct TrackerClock {
  std::string source;                ///< where its samples come from, as --gaze names it
  std::string device;                ///< the tracker's name, as its sender gives it
  std::array<double, 3> turn_deg{};  ///< fixed rotation of its rays: to the left, up, leaning to the left
  std::int64_t clock_ns = 0;         ///< when it was measured, on the computer's clock (CLOCK_MONOTONIC)
  std::int64_t offset_ns = 0;        ///< the computer's clock minus the tracker's
  std::int64_t round_trip_ns = 0;    ///< of the exchange; the offset is right within half of it
};

/// A source of gaze samples, which arrive at the rate of the device. Calls come from the session's thread; a
/// device with its own thread buffers its samples until take().
class GazeSource {
 public:
  virtual ~GazeSource() = default;
  virtual GazeOrigin origin() const = 0;
  /// Begins to buffer samples; call it only with the participant's consent. A source that reports only
  /// changes first adds a sample of the current state.
  virtual void start() = 0;
  /// Returns the samples since start() or the last take(), in the order of sampled_ns.
  virtual std::vector<GazeSample> take() = 0;
  /// Stops buffering and discards the samples that were not taken.
  virtual void stop() = 0;
  /// The newest measured offset of the device's clock, and those measured since the last call; none if the
  /// device gives times of the session's clock.
  virtual std::optional<TrackerClock> clock() { return {}; }
  virtual std::vector<TrackerClock> take_clocks() { return {}; }
  /// Events of the source since the last call, in words for the log.
  virtual std::vector<std::string> take_gaze_news() { return {}; }
  /// Why no usable samples come, in words; empty: not known, or the eyes are not seen.
  virtual std::string trouble() { return ""; }
};

}  // namespace study
