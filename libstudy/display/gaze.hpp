#pragma once
/// Where the participant looks: the one way in which an eye tracker, a headset or the mouse reach a session.

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace study {

/// Whose samples they are. The mouse is no eye: people often look where it is not.
enum class GazeOrigin { Tracker, Mouse };

/// A point of the picture: shares of its width from the left edge and of its height from the top edge.
using GazePoint = std::pair<double, double>;

struct GazeSample {
  std::int64_t sampled_ns = 0;            ///< when it came, on the session's clock
  std::optional<std::int64_t> device_ns;  ///< the device's own time stamp, if it gives one
  bool valid = false;                     ///< the source knows where: no blink, and on the picture
  std::optional<GazePoint> point;         ///< may be known where it is not valid, as beside the picture
};

/// A source of samples at its own rate. Calls come from the session's thread; a device with a thread of its
/// own keeps its samples until they are taken.
class GazeSource {
 public:
  virtual ~GazeSource() = default;
  virtual GazeOrigin origin() const = 0;
  /// From here on samples are kept. A source that tells changes alone begins with what holds now.
  virtual void start() = 0;
  /// Gives what came since start() or the last call, in the order of sampled_ns.
  virtual std::vector<GazeSample> take() = 0;
  /// Nothing is kept any more; what was not taken is forgotten.
  virtual void stop() = 0;
};

}  // namespace study
