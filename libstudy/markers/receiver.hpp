#pragma once
/// Where markers go: a serial port or trigger box, lines over TCP, or the Lab Streaming Layer.

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/markers/marker.hpp"

namespace study {

/// Longest time that write() waits for a receiver that takes nothing, ns.
inline constexpr std::int64_t marker_patience_ns = 100'000'000;

/// A time that never comes.
inline constexpr std::int64_t never_ns = std::numeric_limits<std::int64_t>::max();

/// A receiver of markers. All calls but the constructor come from one thread (MarkerSender).
class MarkerReceiver {
 public:
  virtual ~MarkerReceiver() = default;
  /// Hands the marker over, and waits at most about marker_patience_ns. Returns why the marker is lost, or an
  /// empty text if it was handed over. A later call tries again to reach a receiver that is gone. queued_ns:
  /// when the session sent it, on CLOCK_MONOTONIC.
  virtual std::string write(const Marker& marker, std::int64_t queued_ns) = 0;
  /// The time on CLOCK_MONOTONIC, ns, at which rest() is due; never_ns: no pulse is under way.
  virtual std::int64_t rest_due_ns() const { return never_ns; }
  /// Ends the pulse of the last marker.
  virtual void rest() {}
};

/// How a trigger's pulse goes: the code for pulse_ms, then 0. pulse_ms = 0: no byte 0 is written.
struct MarkerPulse {
  int ms = 10;
};

/// Opens what --markers names:
/// - serial:PATH[:BAUD]: a serial port or a FIFO, one byte per marker; 115200 baud without BAUD;
/// - tcp:[HOST:]PORT: connects, and sends one line per marker; HOST is 127.0.0.1 if left out;
/// - lsl:NAME: a stream of markers of this name in the Lab Streaming Layer.
/// base::Error with a remedy if the text is none of these, or if the receiver cannot be reached.
std::unique_ptr<MarkerReceiver> open_marker_receiver(const std::string& text, const MarkerPulse& pulse);

/// The three kinds; `rest` is the text behind "serial:", "tcp:" and "lsl:", `text` the whole.
std::unique_ptr<MarkerReceiver> open_serial_receiver(const std::string& text, const std::string& rest,
                                                     const MarkerPulse& pulse);
std::unique_ptr<MarkerReceiver> open_tcp_receiver(const std::string& text, const std::string& rest);
std::unique_ptr<MarkerReceiver> open_lsl_receiver(const std::string& text, const std::string& rest);

/// True if both names lead to one receiver: one device or FIFO, or a common address and port. A name that
/// leads nowhere now is compared as text.
bool same_marker_receiver(const std::string& one, const std::string& other);

/// Where the text behind "serial:" or "tcp:" leads: the device or file of a serial port, each address of a
/// TCP receiver. Empty: it leads nowhere.
std::vector<std::string> serial_destinations(const std::string& rest);
std::vector<std::string> tcp_destinations(const std::string& rest);

/// A file descriptor that closes itself.
class MarkerFile {
 public:
  explicit MarkerFile(int descriptor = -1) : descriptor_(descriptor) {}
  ~MarkerFile() { close(); }
  MarkerFile(const MarkerFile&) = delete;
  MarkerFile& operator=(const MarkerFile&) = delete;
  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }
  void reset(int descriptor) {
    close();
    descriptor_ = descriptor;
  }
  void close();

 private:
  int descriptor_;
};

/// Waits until the descriptor takes bytes, at most `most_ns`. False: it did not.
bool wait_until_writable(int descriptor, std::int64_t most_ns);

/// True at most once a second: whether to try again to reach a receiver.
class MarkerRetry {
 public:
  bool due();

 private:
  std::int64_t last_ns_ = 0;
};

}  // namespace study
