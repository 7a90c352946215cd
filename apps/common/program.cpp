#include "apps/common/program.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "apps/common/options.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/utc.hpp"

namespace apps {

namespace {

/// Makes waiting OpenMP threads sleep instead of spin. On a small machine, spinning threads delay the other
/// threads, including the pacing. The OpenMP runtime reads its settings once, before main(), so the program
/// sets them and restarts. Settings of the user are not changed.
void wait_passively(char** argv) {
  if (std::getenv("OMP_WAIT_POLICY") || std::getenv("GOMP_SPINCOUNT")) return;
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  if (program.empty() || setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
  execv(program.c_str(), argv);  // returns only if it fails; the program then continues without the setting
}

std::string version_text(const std::string& program) {
  return program + " " + base::version() + "\nbuilt " + base::built_utc().substr(0, 10) + ": " +
         base::build_options();
}

int run_commands(CLI::App& app, int argc, char** argv) {
  try {
    check_arguments(argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& ended) {  // the exit status that a command chose
    return ended.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const bool asks_for_command = !app.get_subcommands([](const CLI::App*) { return true; }).empty();
  if (!asks_for_command || !app.get_subcommands().empty()) return 0;
  std::fprintf(stderr, "%s", app.help().c_str());
  return 2;
}

}  // namespace

std::string error_text(const std::exception& error, const std::string& command) {
  if (dynamic_cast<const base::Error*>(&error)) return error.what();
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return base::Error(command, "out of memory",
                       "free memory, or use a smaller n_* (--n-star, or n_star in a protocol)")
        .what();
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
    const std::string place = file->path1().empty() ? command : file->path1().string();
    return base::Error(place, "unexpected: " + file->code().message(),
                       "check that path, its permissions and the room on the disk")
        .what();
  }
  return base::Error(command, std::string("unexpected: ") + error.what(),
                     "give the command again; if it ends like this again, report the whole command line")
      .what();
}

std::shared_ptr<CLI::App> new_program(const char* description, const char* name) {
  return std::make_shared<CLI::App>(description, name);
}

int run_program(CLI::App& app, int argc, char** argv) {
  if (!base::open_standard_streams()) return 1;
  wait_passively(argv);
  const base::PlainOutput plain;
  app.set_version_flag("--version", [name = app.get_name()] { return version_text(name); });
  app.require_subcommand(0, 1);
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    return base::for_terminal(CLI::FailureMessage::simple(failed, error)) + "\n";
  });
  check_numbers(app);
  // With these signals ignored, a file-size limit or a pipe without a reader makes the write fail and does
  // not end the process.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const int status = run_commands(app, argc, argv);
    return base::finish_output() ? status : std::max(status, 1);
  } catch (const std::exception& error) {
    const auto chosen = app.get_subcommands();
    const std::string command = app.get_name() + (chosen.empty() ? "" : " " + chosen.front()->get_name());
    std::fprintf(stderr, "%s: error: %s\n", app.get_name().c_str(),
                 base::for_terminal(error_text(error, command)).c_str());
  }
  return 1;
}

}  // namespace apps
