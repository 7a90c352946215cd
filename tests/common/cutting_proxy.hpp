#pragma once
/// A network that can be cut: forwards connections of 127.0.0.1 to a Unix socket.

#include <atomic>
#include <filesystem>
#include <map>
#include <thread>

namespace test {

/// Listens on a free port. A thread forwards bytes in both directions until the destructor.
class CuttingProxy {
 public:
  explicit CuttingProxy(const std::filesystem::path& socket);
  ~CuttingProxy();
  CuttingProxy(const CuttingProxy&) = delete;
  CuttingProxy& operator=(const CuttingProxy&) = delete;

  int port() const { return port_; }
  /// Resets every connection in both directions, with the bytes that are on their way.
  void cut() { cut_ = true; }
  /// Number of connections that cut() reset.
  int cuts() const { return cuts_; }

 private:
  void forward();
  void accept_one();
  void drop(int socket);

  std::filesystem::path target_;
  int listener_ = -1, port_ = 0;
  std::map<int, int> other_;  // the other side of each open socket
  std::atomic<bool> cut_ = false, stop_ = false;
  std::atomic<int> cuts_ = 0;
  std::thread thread_;
};

}  // namespace test
