#pragma once
/// What every program does alike: parse, run, report errors, show progress.

#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace apps {

/// A program without commands. For files that do not read CLI11 themselves: its classes take seconds to
/// compile.
std::shared_ptr<CLI::App> new_program(const char* description, const char* name);

/// Parses the command line and runs the chosen command. 0 = done; 1 = an error, told on stderr, such as
/// output that could not be written (a reader that left a pipe is told nothing); 2 = the command line was
/// wrong (a missing command shows the help); else what a command throws as CLI::RuntimeError. Call it first
/// in main(): it opens /dev/null where a standard stream is closed, and unless OMP_WAIT_POLICY or
/// GOMP_SPINCOUNT is set, it starts the program over, once, with OMP_WAIT_POLICY=passive.
int run_program(CLI::App& app, int argc, char** argv);

/// What an error says on stderr, with place and mend also where it comes from another library, which tells
/// neither. command: as typed, "vip-stats report".
std::string error_text(const std::exception& error, const std::string& command);

/// Makes a folder and its parents unless it is there; base::Error when that fails.
void make_folder(const std::filesystem::path& folder);

/// A line on stderr that shows how far a long step is. Drawn at most ten times a second; a plain line a tenth
/// when stderr is not a terminal. Nothing is shown for steps that end within two seconds.
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
