#pragma once
/// The other ends of markers, for tests: a pseudo-terminal, a listening socket, a library in place of liblsl.

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace test {

/// Waits until there are bytes to read, at most `within_ms`, and reads them. Empty if none came or the file
/// has ended.
inline std::string read_some(int file, int within_ms = 20'000) {
  pollfd input{file, POLLIN, 0};
  char bytes[4096];
  if (::poll(&input, 1, within_ms) != 1) return "";
  const ssize_t count = ::read(file, bytes, sizeof bytes);
  return count > 0 ? std::string(bytes, static_cast<std::size_t>(count)) : "";
}

/// A serial port as a trigger box has it. Its other end, box(), reads the bytes.
class SerialLine {
 public:
  SerialLine() {
    char name[256];
    if (::openpty(&box_, &port_, name, nullptr, nullptr) != 0) throw std::runtime_error("openpty");
    path_ = name;
  }
  ~SerialLine() {
    unplug();
    ::close(port_);
  }
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;
  const std::string& path() const { return path_; }
  /// Reads until `count` bytes have come, or none for a while.
  std::string read(std::size_t count) {
    while (seen_.size() < count) {
      const std::string some = read_some(box_);
      if (some.empty()) break;
      seen_ += some;
    }
    return seen_;
  }
  /// Fills the line, as if the box had stopped reading long ago.
  void fill() {
    const int port = ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY);
    // The kernel moves bytes on for a while, which makes room again.
    for (int full = 0; full < 10;) {
      full = ::write(port, "xxxxxxxx", full > 0 ? 1 : 8) > 0 ? 0 : full + 1;
      if (full > 0) ::usleep(2000);
    }
    ::close(port);
  }
  void unplug() {
    if (box_ >= 0) ::close(box_);
    box_ = -1;
  }

 private:
  int box_ = -1, port_ = -1;
  std::string path_, seen_;
};

/// A program that listens for markers on the loopback address.
class Listener {
 public:
  Listener() {
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1, bytes = 4096;
    ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(socket_, 4) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no socket");
    port_ = ntohs(address.sin_port);
  }
  ~Listener() {
    hang_up();
    ::close(socket_);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  std::string port() const { return std::to_string(port_); }
  /// Takes the next connection.
  void accept() {
    hang_up();
    connection_ = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    seen_.clear();
  }
  /// Reads until `words` have come, or the other side is silent or gone. Returns all that came.
  std::string read_until(const std::string& words) {
    while (seen_.find(words) == std::string::npos) {
      const std::string some = read_some(connection_);
      if (some.empty()) break;
      seen_ += some;
    }
    return seen_;
  }
  int listening() const { return socket_; }
  int connection() const { return connection_; }
  void hang_up() {
    if (connection_ >= 0) ::close(connection_);
    connection_ = -1;
  }

 private:
  int socket_ = -1, connection_ = -1, port_ = 0;
  std::string seen_;
};

/// Compiles lsl_stub.c into `folder` and makes it the library that is opened as liblsl.
class LslStub {
 public:
  explicit LslStub(const std::filesystem::path& folder, int consumers = 1) : log_(folder / "lsl.log") {
    const std::string library = folder / "liblsl_stub.so";
    const std::string line = "cc -shared -fPIC -o '" + library + "' '" VIP_TEST_DIR "/libstudy/lsl_stub.c'";
    if (std::system(line.c_str()) != 0) throw std::runtime_error(line);
    ::setenv("VIP_LSL_LIBRARY", library.c_str(), 1);
    ::setenv("LSL_STUB_LOG", log_.c_str(), 1);
    listen(consumers);
  }
  ~LslStub() { ::unsetenv("VIP_LSL_LIBRARY"); }
  LslStub(const LslStub&) = delete;
  LslStub& operator=(const LslStub&) = delete;
  static void listen(int consumers) { ::setenv("LSL_STUB_CONSUMERS", std::to_string(consumers).c_str(), 1); }
  const std::filesystem::path& log() const { return log_; }

 private:
  std::filesystem::path log_;
};

}  // namespace test
