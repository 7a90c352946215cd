#pragma once
/// Tasks of every program: parse the command line, run, report errors.

#include <exception>
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

}  // namespace apps
