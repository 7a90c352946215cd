#pragma once
/// The lines that the sender of an eye tracker outside OpenXR writes (docs/headset.md has the format).

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace study {

/// A sample as an eye tracker's sender gives it.
struct TrackerSample {
  std::int64_t device_ns = 0;  ///< time of the sample on the tracker's own clock, ns
  bool valid = false;          ///< false: the eyes are lost
  /// Direction of the gaze of both eyes in the head's frame, x right, y up, z back: a unit vector. Only if
  /// valid.
  std::array<double, 3> direction{0, 0, -1};
};

/// The first line: the name of the eye tracker.
struct TrackerHello {
  std::string device;
};

/// The answer to a ping: its number, and the time on the tracker's clock at which the sender answers.
struct TrackerPong {
  std::int64_t number = 0, device_ns = 0;
};

/// A line that is none of the others.
struct UnreadableLine {
  std::string problem;
};

using TrackerLine = std::variant<TrackerHello, TrackerSample, TrackerPong, UnreadableLine>;

/// Longest line, bytes without its end.
inline constexpr std::size_t most_line_bytes = 200;

/// Reads a line without its line feed; a carriage return at its end is left out.
TrackerLine parse_tracker_line(std::string_view line);

/// Line with a line feed that asks the sender for a TrackerPong of this number.
std::string ping_line(std::int64_t number);

/// A direction as a unit vector. False, and no change: its length is 0 or not finite.
bool normalise(std::array<double, 3>& direction);

}  // namespace study
