#pragma once
/// Tasks of every program: parse the command line, run the command, report errors.

#include <exception>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace apps {

/// Makes a program without commands. main.cpp then need not include CLI11, whose headers take seconds to
/// compile.
std::shared_ptr<CLI::App> new_program(const char* description, const char* name);

/// Parses the command line and runs the chosen command. Returns 0 on success and 1 after an error, which is
/// printed on stderr. If stdout is a pipe whose reader has closed it, returns 1 without a message. Returns 2
/// for a wrong command line; a missing command also prints the help. Otherwise returns the code that a
/// command throws as CLI::RuntimeError. Nothing may be printed before the call: run_program() opens /dev/null
/// for closed standard streams and, unless OMP_WAIT_POLICY or GOMP_SPINCOUNT is set, restarts the program
/// once with OMP_WAIT_POLICY=passive.
int run_program(CLI::App& app, int argc, char** argv);

/// The message for an error on stderr. To errors of other libraries, which have neither a place nor a remedy,
/// it adds both. command: the command as typed, such as "vip-stats report".
std::string error_text(const std::exception& error, const std::string& command);

}  // namespace apps
