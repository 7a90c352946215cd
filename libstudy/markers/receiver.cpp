#include "libstudy/markers/receiver.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>

#include "libstudy/base/clock.hpp"
#include "stats/base/error.hpp"

namespace study {

void MarkerFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

bool wait_until_writable(int descriptor, std::int64_t most_ns) {
  pollfd file{descriptor, POLLOUT, 0};
  return ::poll(&file, 1, static_cast<int>(most_ns / 1'000'000)) == 1 && (file.revents & POLLOUT) != 0;
}

bool MarkerRetry::due() {
  const std::int64_t now_ns = RealClock().now_ns();
  if (now_ns - last_ns_ < 1'000'000'000) return false;
  last_ns_ = now_ns;
  return true;
}

std::unique_ptr<MarkerReceiver> open_marker_receiver(const std::string& text, const MarkerPulse& pulse) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const std::string rest = colon == std::string::npos ? std::string() : text.substr(colon + 1);
  const std::string place = "markers to " + text;
  const bool known = kind == "serial" || kind == "tcp" || kind == "lsl";
  if (!known || rest.empty())
    throw base::Error(
        place, known ? "names no receiver" : "is no kind of receiver",
        "write serial:/dev/ttyUSB0, serial:/dev/ttyUSB0:9600, tcp:PORT, tcp:HOST:PORT or lsl:NAME");
  if (kind == "serial") return open_serial_receiver(place, rest, pulse);
  return kind == "tcp" ? open_tcp_receiver(place, rest) : open_lsl_receiver(place, rest);
}

bool same_marker_receiver(const std::string& one, const std::string& other) {
  if (one == other) return true;
  const auto destinations = [](const std::string& text) -> std::vector<std::string> {
    if (text.starts_with("serial:")) return serial_destinations(text.substr(7));
    if (text.starts_with("tcp:")) return tcp_destinations(text.substr(4));
    return {};
  };
  const auto there = destinations(other);
  const auto here = destinations(one);
  return std::find_first_of(here.begin(), here.end(), there.begin(), there.end()) != here.end();
}

}  // namespace study
