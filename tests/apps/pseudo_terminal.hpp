#pragma once
/// Runs a program in its own terminal, as an experimenter does: keys go in, lines come out, and the terminal
/// can be closed.

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace apps::test {

class PseudoTerminal {
 public:
  explicit PseudoTerminal(const std::vector<std::string>& arguments) {
    pid_ = ::forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ < 0) throw std::runtime_error("forkpty");
    if (pid_ > 0) return;
    std::vector<char*> argv;
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    ::execv(argv[0], argv.data());
    ::_exit(126);
  }
  ~PseudoTerminal() {
    if (terminal_ >= 0) ::close(terminal_);
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  void type(const std::string& keys) {
    if (::write(terminal_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size()))
      throw std::runtime_error("the terminal takes no keys");
  }
  /// Reads until the program has written `words`; false if it ends, or is silent for a minute, before that.
  bool wait_for(const std::string& words) {
    while (seen_.find(words) == std::string::npos) {
      pollfd input{terminal_, POLLIN, 0};
      char bytes[4096];
      if (::poll(&input, 1, 60'000) != 1) return false;
      const ssize_t count = ::read(terminal_, bytes, sizeof bytes);
      if (count <= 0) return false;
      seen_.append(bytes, static_cast<std::size_t>(count));
    }
    return true;
  }
  const std::string& seen() const { return seen_; }
  void send(int signal) { ::kill(pid_, signal); }
  /// Closes the terminal.
  void hang_up() {
    ::close(terminal_);
    terminal_ = -1;
  }
  /// The status of waitpid().
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return status;
  }

 private:
  int terminal_ = -1;
  pid_t pid_ = -1;
  std::string seen_;
};

}  // namespace apps::test
