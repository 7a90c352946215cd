#include "libstudy/markers/tcp_socket.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "stats/base/error.hpp"

namespace study {

namespace {

int tcp_error(int socket) {
  int code = 0;
  socklen_t size = sizeof code;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &code, &size) == 0 ? code : errno;
}

std::string reach_tcp(int socket, const TcpAddress& address, std::int64_t patience_ns) {
  if (socket < 0) return std::strerror(errno);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address.bytes), address.size) == 0) return "";
  if (errno != EINPROGRESS) return std::strerror(errno);
  if (!wait_until_writable(socket, patience_ns) && tcp_error(socket) == 0) return "no answer";
  const int code = tcp_error(socket);
  return code == 0 ? "" : std::strerror(code);
}

bool is_loopback(const TcpAddress& address) {
  if (address.bytes.ss_family == AF_INET) {
    sockaddr_in four{};
    std::memcpy(&four, &address.bytes, sizeof four);
    return ntohl(four.sin_addr.s_addr) >> 24 == 127;
  }
  sockaddr_in6 six{};
  std::memcpy(&six, &address.bytes, sizeof six);
  return address.bytes.ss_family == AF_INET6 && IN6_IS_ADDR_LOOPBACK(&six.sin6_addr);
}

}  // namespace

std::vector<TcpAddress> look_up_tcp(const std::string& place, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  std::string host = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoi(port) < 1 || std::stoi(port) > 65535 || host.empty())
    throw base::Error(place, "has no host and port", "write tcp:PORT, tcp:HOST:PORT or tcp:[IPV6]:PORT");
  addrinfo wish{};
  wish.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = ::getaddrinfo(host.c_str(), port.c_str(), &wish, &found); code != 0)
    throw base::Error(place, "host " + host + " was not found: " + ::gai_strerror(code),
                      "write its address, such as 192.168.1.20");
  std::vector<TcpAddress> all;
  for (const addrinfo* one = found; one; one = one->ai_next) {
    TcpAddress address;
    std::memcpy(&address.bytes, one->ai_addr, one->ai_addrlen);
    address.size = one->ai_addrlen;
    all.push_back(address);
  }
  ::freeaddrinfo(found);
  return all;
}

bool all_loopback(const std::vector<TcpAddress>& addresses) {
  return std::all_of(addresses.begin(), addresses.end(), is_loopback);
}

std::string connect_tcp(const std::vector<TcpAddress>& addresses, std::int64_t patience_ns,
                        MarkerFile& socket) {
  std::string reason;
  for (const TcpAddress& address : addresses) {
    socket.reset(::socket(address.bytes.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    reason = reach_tcp(socket.get(), address, patience_ns);
    if (reason.empty()) break;
    socket.close();
  }
  if (!socket.is_open()) return reason;
  const int at_once = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  return "";
}

}  // namespace study
