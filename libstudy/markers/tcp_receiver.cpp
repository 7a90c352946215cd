/// One line for each marker over TCP. The program connects; the recording program listens.

#include <netdb.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "libstudy/markers/receiver.hpp"
#include "libstudy/markers/tcp_socket.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr std::int64_t first_patience_ns = 3'000'000'000;  // to connect before the session

constexpr int send_bytes = 65536;

class TcpReceiver final : public MarkerReceiver {
 public:
  TcpReceiver(const std::string& place, const std::string& rest) : addresses_(look_up_tcp(place, rest)) {
    const std::string reason = connect(first_patience_ns);
    if (!reason.empty())
      throw base::Error(place, "nothing listens there: " + reason,
                        "start the recording program first; nc -l 127.0.0.1 PORT shows the lines");
  }

  std::string write(const Marker& marker, std::int64_t) override {
    if (!socket_.is_open()) {
      if (!retry_.due()) return "the receiver is gone";
      if (const std::string reason = connect(marker_patience_ns); !reason.empty())
        return "the receiver is gone: " + reason;
    }
    if (const std::string reason = look_for_end(); !reason.empty()) return reason;
    // The rest of an earlier line goes first, so that lines stay whole.
    if (const std::string reason = send_rest(); !reason.empty()) return reason;
    rest_ = marker_line(marker);
    const std::size_t whole = rest_.size();
    const std::string reason = send_rest();
    if (!reason.empty() && rest_.size() == whole) rest_.clear();
    return reason;
  }

 private:
  std::string connect(std::int64_t patience_ns) {
    if (const std::string reason = connect_tcp(addresses_, patience_ns, socket_); !reason.empty())
      return reason;
    // A large buffer would hide for hours that the receiver does not read.
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_SNDBUF, &send_bytes, sizeof send_bytes);
    rest_ = marker_header();
    return send_rest();
  }

  /// Reads away what the receiver sends. Returns a reason if it has closed the connection.
  std::string look_for_end() {
    std::array<char, 256> answer{};
    for (;;) {
      const ssize_t count = ::recv(socket_.get(), answer.data(), answer.size(), MSG_DONTWAIT);
      if (count > 0) continue;
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) return "";
      return lost_with(count == 0 ? "it closed the connection" : std::strerror(errno));
    }
  }

  std::string send_rest() {
    while (!rest_.empty()) {
      const ssize_t count = ::send(socket_.get(), rest_.data(), rest_.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count > 0) {
        rest_.erase(0, static_cast<std::size_t>(count));
        continue;
      }
      if (errno != EAGAIN && errno != EINTR) return lost_with(std::strerror(errno));
      if (!wait_until_writable(socket_.get(), marker_patience_ns)) return "the receiver does not read";
    }
    return "";
  }

  std::string lost_with(const std::string& reason) {
    socket_.close();
    rest_.clear();
    return "the receiver is gone: " + reason;
  }

  std::vector<TcpAddress> addresses_;
  MarkerFile socket_;
  MarkerRetry retry_;
  std::string rest_;  ///< bytes of a line that are not sent yet
};

}  // namespace

std::vector<std::string> tcp_destinations(const std::string& rest) {
  std::vector<TcpAddress> addresses;
  try {
    addresses = look_up_tcp("", rest);
  } catch (const base::Error&) {  // open_tcp_receiver() tells what is wrong
    return {};
  }
  std::vector<std::string> out;
  for (const TcpAddress& address : addresses) {
    std::array<char, NI_MAXHOST> host{};
    std::array<char, NI_MAXSERV> port{};
    if (::getnameinfo(reinterpret_cast<const sockaddr*>(&address.bytes), address.size, host.data(),
                      host.size(), port.data(), port.size(), NI_NUMERICHOST | NI_NUMERICSERV) == 0)
      out.push_back(std::string("tcp ") + host.data() + " " + port.data());
  }
  return out;
}

std::unique_ptr<MarkerReceiver> open_tcp_receiver(const std::string& text, const std::string& rest) {
  return std::make_unique<TcpReceiver>(text, rest);
}

}  // namespace study
