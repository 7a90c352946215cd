#pragma once
/// A program under test: starts it, reads it line by line, kills it, waits for it.

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace apps::test {

/// How a program ended.
struct Ended {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;
  std::string out, err;
};

class Process {
 public:
  /// `prepare` runs in the child before the program is loaded.
  explicit Process(const std::vector<std::string>& arguments, const std::function<void()>& prepare = {}) {
    int out[2];
    if (::pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for stdout; raise ulimit -n");
    err_ = std::tmpfile();
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(out[1], STDOUT_FILENO);
      ::dup2(::fileno(err_), STDERR_FILENO);
      if (prepare) prepare();
      std::vector<char*> argv;
      for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
      argv.push_back(nullptr);
      ::execv(argv[0], argv.data());
      ::_exit(126);
    }
    ::close(out[1]);
    out_ = ::fdopen(out[0], "r");
  }
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    stop_reading();
    std::fclose(err_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// The next whole line of stdout; none at the end.
  std::optional<std::string> read_line() {
    std::string line;
    if (!out_) return {};
    for (int c = std::fgetc(out_); c != EOF; c = std::fgetc(out_)) {
      if (c == '\n') {
        seen_ += line + '\n';
        return line;
      }
      line += static_cast<char>(c);
    }
    return {};
  }
  /// Closes the reading end of its stdout.
  void stop_reading() {
    if (out_) std::fclose(out_);
    out_ = nullptr;
  }
  pid_t pid() const { return pid_; }
  void send(int signal) { ::kill(pid_, signal); }
  /// Reads the rest and waits for the end.
  Ended wait() {
    while (read_line()) {
    }
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    Ended ended;
    if (WIFEXITED(status)) ended.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
    ended.out = seen_;
    std::rewind(err_);
    for (int c = std::fgetc(err_); c != EOF; c = std::fgetc(err_)) ended.err += static_cast<char>(c);
    return ended;
  }

 private:
  pid_t pid_ = -1;
  std::FILE* out_ = nullptr;
  std::FILE* err_ = nullptr;
  std::string seen_;
};

inline Ended run_program(const std::vector<std::string>& arguments,
                         const std::function<void()>& prepare = {}) {
  return Process(arguments, prepare).wait();
}

/// Runs a command line in a shell; `out` gets stdout and stderr.
inline Ended run_shell(const std::string& line) { return run_program({"/bin/sh", "-c", line + " 2>&1"}); }

}  // namespace apps::test
