#include "tests/common/cutting_proxy.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <vector>

namespace test {

CuttingProxy::CuttingProxy(const std::filesystem::path& socket) : target_(socket) {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), length) != 0 || ::listen(listener_, 32) != 0 ||
      ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length) != 0)
    throw std::runtime_error("no free port on 127.0.0.1");
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { forward(); });
}

CuttingProxy::~CuttingProxy() {
  stop_ = true;
  thread_.join();
  while (!other_.empty()) drop(other_.begin()->first);
  ::close(listener_);
}

void CuttingProxy::accept_one() {
  const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client < 0) return;
  const int server = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, target_.c_str(), sizeof address.sun_path - 1);
  if (::connect(server, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    ::close(client);  // the server is down
    ::close(server);
    return;
  }
  other_[client] = server;
  other_[server] = client;
}

/// Closes a socket and its other side.
void CuttingProxy::drop(int socket) {
  const int other = other_.at(socket);
  for (const int one : {socket, other}) {
    const linger reset{1, 0};
    ::setsockopt(one, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
    ::close(one);
    other_.erase(one);
  }
}

void CuttingProxy::forward() {
  std::vector<char> buffer(1 << 16);
  while (!stop_) {
    if (cut_.exchange(false)) {
      cuts_ += static_cast<int>(other_.size() / 2);
      while (!other_.empty()) drop(other_.begin()->first);
    }
    std::vector<pollfd> ready{{listener_, POLLIN, 0}};
    for (const auto& [socket, other] : other_) ready.push_back({socket, POLLIN, 0});
    if (::poll(ready.data(), ready.size(), 2) <= 0) continue;
    if (ready[0].revents != 0) accept_one();
    for (std::size_t i = 1; i < ready.size(); ++i) {
      const auto to = other_.find(ready[i].fd);
      if (ready[i].revents == 0 || to == other_.end()) continue;
      const ssize_t read = ::recv(ready[i].fd, buffer.data(), buffer.size(), 0);
      // Blocks while the other side is slow, which is no matter here.
      if (read <= 0 ||
          ::send(to->second, buffer.data(), static_cast<std::size_t>(read), MSG_NOSIGNAL) != read)
        drop(ready[i].fd);
    }
  }
}

}  // namespace test
