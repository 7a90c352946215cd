#include "tests/faults/workers.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"

namespace faults {

using Say = std::function<void(const std::string&)>;

namespace {

[[noreturn]] void run_worker(int worker, int out, const std::function<void(int, const Say&)>& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const Say say = [out](const std::string& text) {
    std::string line = text;
    for (char& c : line) c = c == '\n' ? ' ' : c;
    line += '\n';
    // Lines shorter than PIPE_BUF are written as a whole.
    if (line.size() > 4000) line = line.substr(0, 3999) + '\n';
    if (::write(out, line.data(), line.size()) < 0) ::_exit(2);
  };
  try {
    work(worker, say);
  } catch (const std::exception& error) {
    say("FAILED worker: " + std::string(error.what()));
    ::_exit(1);
  }
  ::_exit(0);
}

/// Fills the process's cache of schemas, one per version, before children are forked and share it. Otherwise
/// each child would spend half of its time on building them.
void make_schemas() {
  const auto steps = study::read_schema_steps();
  for (std::size_t version = 1; version <= steps.size(); ++version) {
    const study::SchemaSteps first(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(version));
    study::check_schema(*study::make_temporary_database("the schema", first), steps,
                        static_cast<std::int64_t>(version));
  }
  study::columns_of("session");
}

}  // namespace

bool spread(int jobs, const std::function<void(int, const Say&)>& work, const Say& take) {
  int pipe[2];
  if (::pipe(pipe) != 0) throw std::runtime_error("no pipe can be made; mend: raise ulimit -n");
  make_schemas();
  std::fflush(stdout);
  std::vector<pid_t> children;
  for (int worker = 0; worker < jobs; ++worker) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(pipe[0]);
      run_worker(worker, pipe[1], work);
    }
    children.push_back(child);
  }
  ::close(pipe[1]);
  std::string rest;
  char part[4096];
  for (ssize_t n; (n = ::read(pipe[0], part, sizeof part)) > 0;) {
    rest.append(part, static_cast<std::size_t>(n));
    for (std::size_t end; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1))
      take(rest.substr(0, end));
  }
  ::close(pipe[0]);
  bool good = true;
  for (const pid_t child : children) {
    int status = 0;
    ::waitpid(child, &status, 0);
    good = good && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  return good;
}

}  // namespace faults
