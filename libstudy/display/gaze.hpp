#pragma once
/// Where the participant looks: the interface through which an eye tracker, a headset or the mouse feeds a
/// session.

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace study {

/// The device behind the samples. Mouse and head are only stand-ins: people often look elsewhere.
enum class GazeOrigin { Tracker, Head, Mouse };

/// A point of the picture: fractions of its width from the left edge and of its height from the top edge.
using GazePoint = std::pair<double, double>;

/// The combined (cyclopean) ray of both eyes in the head's frame: x right, y up, z back from the midpoint of
/// the eyes. The head's pose (headset.hpp) transforms it to the room.
struct GazeRay {
  std::array<double, 3> origin_m{};
  std::array<double, 3> direction{0, 0, -1};  ///< unit vector
};

struct GazeSample {
  std::int64_t sampled_ns = 0;            ///< arrival time, on the session's clock
  std::optional<std::int64_t> device_ns;  ///< the device's own time stamp, if it gives one
  bool valid = false;                     ///< false during a blink or with the pointer off the picture
  std::optional<GazePoint> point;         ///< may be set even if not valid, e.g. beside the picture
  std::optional<bool> tracked{};  ///< false: estimated by the source (sub-nominal); none: not reported
  std::optional<GazeRay> ray{};   ///< none: the source gives only points of the picture
};

/// A source of samples at its own rate. Calls come from the session's thread; a device with its own thread
/// buffers its samples until take().
class GazeSource {
 public:
  virtual ~GazeSource() = default;
  virtual GazeOrigin origin() const = 0;
  /// Begins to buffer samples; the participant has allowed it. A source that reports only changes first adds
  /// the current state.
  virtual void start() = 0;
  /// Returns the samples since start() or the last call, in the order of sampled_ns.
  virtual std::vector<GazeSample> take() = 0;
  /// Stops buffering and discards the samples that were not taken.
  virtual void stop() = 0;
};

}  // namespace study
