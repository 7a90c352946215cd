#include "stats/base/streams.hpp"

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

namespace base {

namespace {

constexpr std::size_t line_bytes = 1000;
constexpr int most_lines = 200;

/// True if stdout is a pipe or socket whose reader has closed it.
bool reader_left() {
  pollfd out{STDOUT_FILENO, 0, 0};
  return ::poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

namespace {

bool write_out(const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(STDOUT_FILENO, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

ssize_t write_plain(void* text, const char* bytes, std::size_t size) {
  return write_out(static_cast<TerminalText*>(text)->next({bytes, size})) ? static_cast<ssize_t>(size) : 0;
}

}  // namespace

PlainOutput::PlainOutput() : before_(stdout) {
  std::fflush(stdout);
  plain_ = ::fopencookie(&text_, "w", {nullptr, write_plain, nullptr, nullptr});
  if (!plain_) throw Error("standard output", "cannot be opened", "free memory and do this again");
  std::setvbuf(plain_, nullptr, ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF, BUFSIZ);
  stdout = plain_;
}

PlainOutput::~PlainOutput() {
  std::fflush(plain_);
  write_out(text_.rest());
  stdout = before_;
  std::fclose(plain_);
}

void print_coloured(const std::string& text) {
  std::fflush(stdout);
  TerminalText plain;
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t colour = text.find("\033[", at);
    const std::size_t end =
        colour == std::string::npos ? colour : text.find_first_not_of("0123456789", colour + 2);
    if (end == std::string::npos) {
      out += plain.next(std::string_view(text).substr(at));
      break;
    }
    out += plain.next(std::string_view(text).substr(at, colour - at));
    const bool is_colour = text[end] == 'm';
    out += is_colour ? text.substr(colour, end + 1 - colour) : std::string("?");
    at = is_colour ? end + 1 : colour + 1;
  }
  write_out(out + plain.rest());
}

// open() returns the lowest free number, so opening in ascending order fills the gaps. Programs started by
// exec inherit the descriptors.
bool open_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) < 0 && ::open("/dev/null", O_RDWR) != fd) return false;
  }
  return true;
}

bool finish_output() {
  errno = 0;
  std::cout.flush();  // cout bypasses PlainOutput
  const bool flushed = std::fflush(stdout) == 0 && std::cout.good();
  const std::string why = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  if (flushed && !std::ferror(stdout)) return true;
  if (reader_left()) return false;
  throw Error("standard output", "cannot be written" + why,
              "free space, or redirect the output to another file");
}

std::string for_terminal(const std::string& message) {
  std::istringstream lines(message);
  std::string out;
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    if (count == most_lines) return out + "...";
    out += (count > 0 ? "\n" : "") + shortened(line, line_bytes);
  }
  return out;
}

}  // namespace base
