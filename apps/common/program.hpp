#pragma once
/// Tasks of every program: parse the command line, run, report errors, show progress.

#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace apps {

/// Makes a program without commands, for files that do not include CLI11: its classes take seconds to
/// compile.
std::shared_ptr<CLI::App> new_program(const char* description, const char* name);

/// Parses the command line and runs the chosen command. Returns 0 if done; 1 after an error, which is printed
/// on stderr, such as output that could not be written (no message if the reader of a pipe left); 2 if the
/// command line was wrong (a missing command shows the help); otherwise the code that a command throws as
/// CLI::RuntimeError. Call it first in main(): it opens /dev/null for closed standard streams and, unless
/// OMP_WAIT_POLICY or GOMP_SPINCOUNT is set, restarts the program once with OMP_WAIT_POLICY=passive.
int run_program(CLI::App& app, int argc, char** argv);

/// The message for an error on stderr. Adds place and remedy to errors of other libraries, which lack them.
/// command: as typed, "vip-stats report".
std::string error_text(const std::exception& error, const std::string& command);

/// Makes a folder and its parents if missing; base::Error on failure.
void make_folder(const std::filesystem::path& folder);

/// Shows the progress of a long step on stderr: a line redrawn at most ten times a second, or one plain line
/// per tenth if stderr is not a terminal. Shows nothing for steps that end within two seconds.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void update(std::size_t done);

 private:
  void draw(std::size_t done);

  std::string label_;
  std::size_t total_;
  double started_s_;
  double drawn_s_ = 0;
  int drawn_tenth_ = -1;
  bool terminal_;
};

}  // namespace apps
