#pragma once
/// Where samples of an eye tracker outside OpenXR come from: lines over TCP, or a stream of the Lab Streaming
/// Layer.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/trackers/tracker_line.hpp"

namespace study {

/// A measured offset between the computer's clock and the tracker's.
struct ClockOffset {
  std::int64_t clock_ns = 0;       ///< when it was measured, on CLOCK_MONOTONIC
  std::int64_t offset_ns = 0;      ///< CLOCK_MONOTONIC minus the tracker's clock
  std::int64_t round_trip_ns = 0;  ///< the offset is right within half of this
};

/// The way to a sender. All calls come from one thread at a time. No call waits for more than a second,
/// besides the opening and the first measure().
class TrackerLink {
 public:
  virtual ~TrackerLink() = default;
  /// The eye tracker's name, as the sender gives it.
  virtual std::string device() const = 0;
  /// Waits at most most_ns, and adds the samples that came to `out`. Returns why the sender is gone, or an
  /// empty text.
  virtual std::string read(std::vector<TrackerSample>& out, std::int64_t most_ns) = 0;
  /// Begins to measure the offset; read() goes on with it.
  virtual void measure() = 0;
  /// An offset whose measurement has ended since the last call.
  virtual std::optional<ClockOffset> take_offset() = 0;
  /// Tries to reach a sender that is gone. Returns why it failed, or an empty text.
  virtual std::string reach() = 0;
  /// Lines or values since the last call that were no samples. Their text is not kept: it may be gaze.
  virtual std::int64_t take_unreadable() = 0;
};

/// True if a text of --gaze names an eye tracker outside OpenXR: "tcp:..." or "lsl:...".
bool is_outside_tracker(const std::string& gaze);
/// True if the samples cross a network: the host of "tcp:..." is another computer, or the stream is an LSL
/// one. base::Error if the host is not found.
bool crosses_network(const std::string& gaze);

/// Opens what --gaze names: "tcp:[HOST:]PORT", where HOST is 127.0.0.1 if left out, or "lsl:NAME".
/// base::Error with a remedy if the text is neither, if nobody sends there, or if liblsl is missing.
std::unique_ptr<TrackerLink> open_tracker_link(const std::string& gaze);

/// The two kinds; `place` names the source in errors, `rest` is the text behind "tcp:" or "lsl:".
std::unique_ptr<TrackerLink> open_tcp_tracker(const std::string& place, const std::string& rest);
std::unique_ptr<TrackerLink> open_lsl_tracker(const std::string& place, const std::string& rest);

}  // namespace study
