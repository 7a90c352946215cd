/// One byte for each marker on a serial port, a trigger box or a FIFO.

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "libstudy/markers/receiver.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// A trigger that comes later than this after the session sent it would mark another instant; it is not
/// written, ns.
constexpr std::int64_t stale_ns = 250'000'000;

constexpr std::array<std::pair<int, speed_t>, 12> bauds{{{1200, B1200},
                                                         {2400, B2400},
                                                         {4800, B4800},
                                                         {9600, B9600},
                                                         {19200, B19200},
                                                         {38400, B38400},
                                                         {57600, B57600},
                                                         {115200, B115200},
                                                         {230400, B230400},
                                                         {460800, B460800},
                                                         {921600, B921600},
                                                         {2000000, B2000000}}};

struct SerialAddress {
  std::string path;
  std::string baud;  ///< as written; empty: not given
};

/// Splits PATH[:BAUD]. Only digits behind the last colon are a rate: paths in /dev/serial/by-path have
/// colons.
SerialAddress parse_serial(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {text, ""};
  const std::string end = text.substr(colon + 1);
  const bool digits = !end.empty() && end.find_first_not_of("0123456789") == std::string::npos;
  return digits ? SerialAddress{text.substr(0, colon), end} : SerialAddress{text, ""};
}

speed_t speed_of(const std::string& baud, const std::string& place) {
  if (baud.empty()) return B115200;
  std::string known;
  for (const auto& [rate, speed] : bauds) {
    if (std::to_string(rate) == baud) return speed;
    known += (known.empty() ? "" : ", ") + std::to_string(rate);
  }
  throw base::Error(place, baud + " is no baud rate of serial ports", "write one of " + known);
}

void sleep_until(std::int64_t deadline_ns) {
  const timespec target{deadline_ns / 1'000'000'000, deadline_ns % 1'000'000'000};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &target, nullptr) == EINTR) {
  }
}

class SerialReceiver final : public MarkerReceiver {
 public:
  SerialReceiver(const std::string& place, const std::string& rest, const MarkerPulse& pulse)
      : place_(place), address_(parse_serial(rest)), pulse_ns_(1'000'000LL * pulse.ms) {
    speed_ = speed_of(address_.baud, place_);
    open();
    if (pulse_ns_ > 0) put(0);
  }

  ~SerialReceiver() override {
    if (raised_) rest();
  }

  std::string write(const Marker& marker, std::int64_t queued_ns) override {
    if (!file_.is_open() && !reopen()) return "the port is gone";
    if (raised_) {
      sleep_until(rest_due_ns());
      rest();
    }
    // Two codes without enough time at 0 between them are one for a recording system.
    sleep_until(std::min(rested_ns_ + pulse_ns_ / 2, RealClock().now_ns() + pulse_ns_));
    if (RealClock().now_ns() - queued_ns > stale_ns) return "too late for a trigger";
    std::string lost = put(static_cast<unsigned char>(marker_code(marker)));
    if (!lost.empty()) return lost;
    raised_ = pulse_ns_ > 0;
    raised_ns_ = RealClock().now_ns();
    return drain();
  }

  std::int64_t rest_due_ns() const override { return raised_ ? raised_ns_ + pulse_ns_ : never_ns; }

  void rest() override {
    raised_ = false;
    if (file_.is_open()) put(0);
    rested_ns_ = RealClock().now_ns();
  }

 private:
  void open() {
    struct stat found {};
    const std::string& path = address_.path;
    if (::stat(path.c_str(), &found) != 0)
      throw base::Error(place_, path + ": " + std::strerror(errno),
                        "name the port; ls /dev/serial/by-id lists those of USB");
    if (!S_ISCHR(found.st_mode) && !S_ISFIFO(found.st_mode))
      throw base::Error(place_, path + " is neither a serial port nor a FIFO",
                        "name a device such as /dev/ttyUSB0, or a FIFO (mkfifo)");
    file_.reset(::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (file_.is_open()) return set_up();
    if (errno == ENXIO)
      throw base::Error(place_, "no program reads " + path, "start the program that reads it first");
    throw base::Error(place_, path + " cannot be opened: " + std::strerror(errno),
                      errno == EACCES ? "add the user to the port's group (often dialout), and log in again"
                                      : "close the program that has the port open, or name another port");
  }

  void set_up() {
    if (::isatty(file_.get()) == 0) {
      if (address_.baud.empty()) return;
      throw base::Error(place_, address_.path + " is no terminal, so it has no baud rate",
                        "leave out :" + address_.baud);
    }
    termios settings{};
    bool good = ::tcgetattr(file_.get(), &settings) == 0;
    ::cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL;
    settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
    ::cfsetspeed(&settings, speed_);
    good = good && ::tcsetattr(file_.get(), TCSANOW, &settings) == 0;
    if (!good)
      throw base::Error(place_, address_.path + " cannot be set to this rate: " + std::strerror(errno),
                        "name a rate that the port has, such as " + address_.path + ":9600");
  }

  bool reopen() {
    if (!retry_.due()) return false;
    try {
      open();
    } catch (const base::Error&) {
      file_.close();
    }
    return file_.is_open();
  }

  /// Writes one byte; returns why it was not written.
  std::string put(unsigned char byte) {
    for (int tries = 0; tries < 2; ++tries) {
      if (::write(file_.get(), &byte, 1) == 1) return "";
      if (errno != EAGAIN && errno != EINTR) {
        const std::string reason = std::strerror(errno);
        file_.close();
        return "the port is gone: " + reason;
      }
      if (!wait_until_writable(file_.get(), marker_patience_ns)) break;
    }
    return "the port takes nothing";
  }

  /// Waits until the byte has left the computer's buffer. Pipes cannot tell.
  std::string drain() {
    const std::int64_t until_ns = RealClock().now_ns() + marker_patience_ns;
    int left = 0;
    while (::ioctl(file_.get(), TIOCOUTQ, &left) == 0 && left > 0) {
      if (RealClock().now_ns() > until_ns) return "the port does not send";
      sleep_until(RealClock().now_ns() + 20'000);
    }
    return "";
  }

  std::string place_;
  SerialAddress address_;
  std::int64_t pulse_ns_;
  speed_t speed_ = B115200;
  MarkerFile file_;
  MarkerRetry retry_;
  bool raised_ = false;  ///< true: a code is on the lines
  std::int64_t raised_ns_ = 0, rested_ns_ = 0;
};

}  // namespace

std::vector<std::string> serial_destinations(const std::string& rest) {
  struct stat found {};
  if (::stat(parse_serial(rest).path.c_str(), &found) != 0) return {};
  if (S_ISCHR(found.st_mode)) return {"serial device " + std::to_string(found.st_rdev)};
  return {"serial file " + std::to_string(found.st_dev) + " " + std::to_string(found.st_ino)};
}

std::unique_ptr<MarkerReceiver> open_serial_receiver(const std::string& text, const std::string& rest,
                                                     const MarkerPulse& pulse) {
  return std::make_unique<SerialReceiver>(text, rest, pulse);
}

}  // namespace study
