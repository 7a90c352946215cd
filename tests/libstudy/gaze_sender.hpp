#pragma once
/// The sender of an eye tracker outside OpenXR, for tests: lines over TCP on a thread of its own.

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "tests/libstudy/marker_receivers.hpp"

namespace test {

/// Takes one connection after the other, greets, answers pings, and sends samples straight ahead.
class GazeSender {
 public:
  struct Ways {
    double rate_hz = 200;
    double ahead_s = 1000;  ///< the tracker's clock minus the computer's
    std::string hello = "vip-gaze 1 A tracker\n";
    bool answers_pings = true;
    int pong_delay_ms = 0;  ///< from reading its clock to the answer
    std::string direction = "0 0 -1";
  };
  GazeSender() : GazeSender(Ways()) {}
  explicit GazeSender(Ways ways) : ways_(std::move(ways)), thread_([this] { work(); }) {}
  ~GazeSender() {
    stopping = true;
    thread_.join();
  }
  GazeSender(const GazeSender&) = delete;
  GazeSender& operator=(const GazeSender&) = delete;

  std::string name() const { return "tcp:" + listener_.port(); }
  /// Sends any text next.
  void say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    said_ += text;
  }
  /// The time on the tracker's clock as a sample's text has it, `later_s` from now.
  std::string time(double later_s = 0) const {
    return fmt::format("{:.9f}",
                       1e-9 * static_cast<double>(study::RealClock().now_ns()) + ways_.ahead_s + later_s);
  }

  std::atomic<bool> valid = true;    ///< the eyes are seen
  std::atomic<bool> silent = false;  ///< samples are left out
  std::atomic<bool> gone = false;    ///< hangs up, and takes no connection until it is false again
  std::atomic<bool> stopping = false;
  std::atomic<int> sent = 0;
  std::atomic<int> gone_after = -1;  ///< is gone once so many samples were sent; -1: never

 private:
  void work() {
    auto due = std::chrono::steady_clock::now();
    bool connected = false;
    std::string asked;
    while (!stopping) {
      if (gone) {
        if (connected) listener_.hang_up();
        connected = false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      if (!connected) {
        pollfd waiting{listener_.listening(), POLLIN, 0};
        if (::poll(&waiting, 1, 5) != 1) continue;
        listener_.accept();
        connected = true;
        asked.clear();
        send(ways_.hello);
        due = std::chrono::steady_clock::now();
      }
      connected = answer(asked);
      {
        const std::lock_guard lock(mutex_);
        send(std::exchange(said_, {}));
      }
      if (std::chrono::steady_clock::now() < due) continue;
      due += std::chrono::nanoseconds(std::llround(1e9 / ways_.rate_hz));
      if (silent) continue;
      send("g " + time() + (valid ? " 1 " + ways_.direction : std::string(" 0")) + "\n");
      if (++sent == gone_after) gone = true;
    }
  }
  /// Waits for pings for a millisecond. False: the other side is gone.
  bool answer(std::string& asked) {
    pollfd input{listener_.connection(), POLLIN, 0};
    if (::poll(&input, 1, 1) != 1) return true;
    char bytes[512];
    const ssize_t count = ::recv(listener_.connection(), bytes, sizeof bytes, MSG_DONTWAIT);
    if (count <= 0) return false;
    asked.append(bytes, static_cast<std::size_t>(count));
    for (std::size_t end = asked.find('\n'); end != std::string::npos; end = asked.find('\n')) {
      const std::string pong = asked.substr(0, end) + " " + time() + "\n";
      std::this_thread::sleep_for(std::chrono::milliseconds(ways_.pong_delay_ms));
      if (ways_.answers_pings) send(pong);
      asked.erase(0, end + 1);
    }
    return true;
  }
  void send(const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count =
          ::send(listener_.connection(), text.data() + done, text.size() - done, MSG_NOSIGNAL);
      if (count <= 0) return;
      done += static_cast<std::size_t>(count);
    }
  }

  Ways ways_;
  Listener listener_;
  std::mutex mutex_;
  std::string said_;
  std::thread thread_;
};

}  // namespace test
