#pragma once
/// Where the participant looks: the one way in which an eye tracker, a headset or the mouse reach a session.

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace study {

/// Whose samples they are. Neither mouse nor head is an eye: people often look where it is not.
enum class GazeOrigin { Tracker, Head, Mouse };

/// A point of the picture: shares of its width from the left edge and of its height from the top edge.
using GazePoint = std::pair<double, double>;

/// The one ray of both eyes (cyclopean), in the head's frame: right, up and back of the middle between the
/// eyes. The head's pose (headset.hpp) carries it into the room.
struct GazeRay {
  std::array<double, 3> origin_m{};
  std::array<double, 3> direction{0, 0, -1};  ///< unit vector
};

struct GazeSample {
  std::int64_t sampled_ns = 0;            ///< when it came, on the session's clock
  std::optional<std::int64_t> device_ns;  ///< the device's own time stamp, if it gives one
  bool valid = false;                     ///< the source knows where: no blink, no pointer off the picture
  std::optional<GazePoint> point;         ///< may be known where it is not valid, as beside the picture
  std::optional<bool> tracked{};  ///< false: a guess of the source (sub-nominal); none: it does not tell
  std::optional<GazeRay> ray{};   ///< none: the source knows points of the picture alone
};

/// A source of samples at its own rate. Calls come from the session's thread; a device with a thread of its
/// own keeps its samples until they are taken.
class GazeSource {
 public:
  virtual ~GazeSource() = default;
  virtual GazeOrigin origin() const = 0;
  /// From here on samples are kept: the participant allows it. A source that tells changes alone begins with
  /// what holds now.
  virtual void start() = 0;
  /// Gives what came since start() or the last call, in the order of sampled_ns.
  virtual std::vector<GazeSample> take() = 0;
  /// Nothing is kept any more; what was not taken is forgotten.
  virtual void stop() = 0;
};

}  // namespace study
