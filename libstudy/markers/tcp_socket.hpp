#pragma once
/// TCP connections to recording programs and eye trackers: addresses, and a connection within a limited time.

#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/markers/receiver.hpp"

namespace study {

struct TcpAddress {
  sockaddr_storage bytes{};
  socklen_t size = 0;
};

/// Splits [HOST:]PORT, with an IPv6 host in brackets, and looks the host up; without HOST it is 127.0.0.1.
/// base::Error naming `place` if the text is no host and port, or if the host is not found.
std::vector<TcpAddress> look_up_tcp(const std::string& place, const std::string& text);

/// True if all addresses are this computer's own (127.0.0.0/8 or ::1).
bool all_loopback(const std::vector<TcpAddress>& addresses);

/// Connects `socket` to the first address that answers, each within patience_ns. The socket does not block.
/// Returns an empty text, or why nothing answers; `socket` is closed then.
std::string connect_tcp(const std::vector<TcpAddress>& addresses, std::int64_t patience_ns,
                        MarkerFile& socket);

}  // namespace study
