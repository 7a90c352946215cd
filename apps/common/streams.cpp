#include "apps/common/streams.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

constexpr std::size_t line_bytes = 1000;
constexpr int most_lines = 200;

/// A pipe or socket without a reader.
bool reader_left() {
  pollfd out{STDOUT_FILENO, 0, 0};
  return ::poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

// The lowest free number is given first, and what is opened here stays open over exec.
bool open_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) != fd) return false;
  }
  return true;
}

bool finish_output() {
  std::cout.flush();
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0;
  const std::string why = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  if (flushed && !std::ferror(stdout)) return true;
  if (reader_left()) return false;
  throw base::Error("standard output", "cannot be written" + why, "free space, or send it elsewhere");
}

std::string for_terminal(const std::string& message) {
  std::istringstream lines(message);
  std::string out;
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    if (count == most_lines) return out + "...";
    out += (count > 0 ? "\n" : "") + base::shortened(line, line_bytes);
  }
  return out;
}

}  // namespace apps
