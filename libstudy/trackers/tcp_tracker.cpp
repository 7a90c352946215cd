/// Lines of gaze over TCP. The program connects; the eye tracker's sender listens.

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "libstudy/markers/tcp_socket.hpp"
#include "libstudy/trackers/tracker_link.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr std::int64_t ms_ns = 1'000'000;
constexpr std::int64_t opening_ns = 3000 * ms_ns;  // to connect, and to get the first line, before a session
constexpr std::int64_t again_ns = 500 * ms_ns;     // to connect to a sender that was gone
constexpr int pings_for_an_offset = 10;
constexpr std::int64_t pong_within_ns = 200 * ms_ns;
/// Bytes that one read() takes. A sender that floods is left waiting then, and its samples come too late.
constexpr std::size_t most_read_bytes = 1 << 16;
constexpr std::size_t too_long = most_line_bytes + 2;  // with a carriage return
constexpr std::int64_t flood_pause_ns = 10 * ms_ns;
constexpr const char* example = "docs/headset.md has an example of a sender";

class TcpTracker final : public TrackerLink {
 public:
  TcpTracker(const std::string& place, const std::string& rest) : addresses_(look_up_tcp(place, rest)) {
    if (const std::string reason = connect(opening_ns); !reason.empty())
      throw base::Error(place, "no sender of gaze listens there: " + reason,
                        std::string("start the eye tracker's sender first; ") + example);
    std::vector<TrackerSample> ignored;
    std::string reason;
    while (device_.empty() && reason.empty()) reason = read(ignored, 10 * ms_ns);
    if (!reason.empty()) throw base::Error(place, reason, example);
  }

  std::string device() const override { return device_; }

  std::string read(std::vector<TrackerSample>& out, std::int64_t most_ns) override {
    if (!socket_.is_open()) return "it is not connected";
    const std::int64_t now_ns = RealClock().now_ns();
    if (!greeted_ && now_ns - connected_ns_ > opening_ns)
      return lost("it sent no first line 'vip-gaze 1 NAME' within 3 s");
    if (pinged_ns_ > 0 && now_ns - pinged_ns_ > pong_within_ns) next_ping();
    if (!unsent_.empty()) send();
    pollfd file{socket_.get(), POLLIN, 0};
    if (::poll(&file, 1, static_cast<int>(std::max<std::int64_t>(1, most_ns / ms_ns))) != 1) return "";
    std::array<char, 4096> bytes{};
    for (std::size_t taken = 0; taken < most_read_bytes;) {
      const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) return "";
      if (count <= 0) return lost(count == 0 ? "it closed the connection" : std::strerror(errno));
      const std::int64_t came_ns = RealClock().now_ns();
      if (const std::string reason = take({bytes.data(), static_cast<std::size_t>(count)}, came_ns, out);
          !reason.empty())
        return reason;
      taken += static_cast<std::size_t>(count);
    }
    RealClock().wait_until(RealClock().now_ns() + flood_pause_ns);
    return "";
  }

  void measure() override {
    pings_left_ = pings_for_an_offset;
    best_.reset();
    next_ping();
  }

  std::optional<ClockOffset> take_offset() override { return std::exchange(measured_, {}); }
  std::string reach() override { return connect(again_ns); }
  std::int64_t take_unreadable() override { return std::exchange(unreadable_, 0); }

 private:
  std::string connect(std::int64_t patience_ns) {
    line_.clear();
    unsent_.clear();
    greeted_ = false;
    pinged_ns_ = pings_left_ = 0;
    std::string reason = connect_tcp(addresses_, patience_ns, socket_);
    connected_ns_ = RealClock().now_ns();
    return reason;
  }

  std::string lost(std::string reason) {
    socket_.close();
    return reason;
  }

  /// Cuts the bytes into lines. Returns why the other side is no sender of gaze, or an empty text.
  std::string take(std::string_view bytes, std::int64_t came_ns, std::vector<TrackerSample>& out) {
    while (!bytes.empty()) {
      const std::size_t end = bytes.find('\n');
      const bool whole = end != std::string_view::npos;
      const std::string_view part = bytes.substr(0, whole ? end : bytes.size());
      bytes.remove_prefix(whole ? end + 1 : bytes.size());
      line_ += part;
      // A line without an end must not fill the memory: a byte too many already makes it unreadable.
      if (line_.size() > too_long) line_.resize(too_long);
      if (!whole) break;
      const std::string line = std::exchange(line_, {});
      if (std::string reason = take_line(line, came_ns, out); !reason.empty()) return reason;
    }
    return "";
  }

  std::string take_line(const std::string& text, std::int64_t came_ns, std::vector<TrackerSample>& out) {
    const TrackerLine line = parse_tracker_line(text);
    if (!greeted_) {
      const auto* hello = std::get_if<TrackerHello>(&line);
      if (!hello) return lost("its first line is not 'vip-gaze 1 NAME'");
      device_ = hello->device;
      greeted_ = true;
    } else if (const auto* sample = std::get_if<TrackerSample>(&line)) {
      out.push_back(*sample);
    } else if (const auto* pong = std::get_if<TrackerPong>(&line)) {
      take_pong(*pong, came_ns);
    } else {
      ++unreadable_;
    }
    return "";
  }

  void take_pong(const TrackerPong& pong, std::int64_t came_ns) {
    if (pinged_ns_ == 0 || pong.number != ping_) return;  // an answer to an earlier ping
    const std::int64_t round_trip_ns = came_ns - pinged_ns_;
    if (!best_ || round_trip_ns < best_->round_trip_ns)
      best_ = ClockOffset{came_ns, pinged_ns_ + round_trip_ns / 2 - pong.device_ns, round_trip_ns};
    next_ping();
  }

  void next_ping() {
    pinged_ns_ = 0;
    if (pings_left_ == 0) {
      measured_ = std::exchange(best_, {});
      return;
    }
    --pings_left_;
    unsent_ += ping_line(++ping_);
    pinged_ns_ = RealClock().now_ns();  // before the call: the answer may be there when it returns
    send();
  }

  /// Sends what the socket takes; the rest waits for the next read().
  void send() {
    const ssize_t count = ::send(socket_.get(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) unsent_.erase(0, static_cast<std::size_t>(count));
  }

  std::vector<TcpAddress> addresses_;
  MarkerFile socket_;
  std::string device_;
  std::int64_t connected_ns_ = 0;
  std::string line_;      ///< bytes of a line that is not whole yet
  bool greeted_ = false;  ///< the first line came
  std::int64_t unreadable_ = 0;
  std::string unsent_;  ///< bytes of a ping that are not sent yet
  int pings_left_ = 0;
  std::int64_t ping_ = 0;       ///< number of the last ping
  std::int64_t pinged_ns_ = 0;  ///< when it was sent; 0: no ping waits for its answer
  std::optional<ClockOffset> best_, measured_;
};

}  // namespace

bool is_outside_tracker(const std::string& gaze) {
  return gaze.starts_with("tcp:") || gaze.starts_with("lsl:");
}

bool crosses_network(const std::string& gaze) {
  return gaze.starts_with("lsl:") || !all_loopback(look_up_tcp("--gaze " + gaze, gaze.substr(4)));
}

std::unique_ptr<TrackerLink> open_tracker_link(const std::string& gaze) {
  const std::string place = "gaze from " + gaze;
  if (!is_outside_tracker(gaze) || gaze.size() == 4)
    throw base::Error(place, "names no eye tracker", "write tcp:PORT, tcp:HOST:PORT or lsl:NAME");
  const std::string rest = gaze.substr(4);
  return gaze.starts_with("tcp:") ? open_tcp_tracker(place, rest) : open_lsl_tracker(place, rest);
}

std::unique_ptr<TrackerLink> open_tcp_tracker(const std::string& place, const std::string& rest) {
  return std::make_unique<TcpTracker>(place, rest);
}

}  // namespace study
