#include "tests/faults/child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "stats/base/error.hpp"

namespace faults {

namespace {

constexpr unsigned longest_s = 60;
constexpr const char* broken = "!";  // prefix of errors that are not base::Error

[[noreturn]] void work(const CallPlan& plan, const std::function<void()>& command) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::alarm(longest_s);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  std::string problem;
  arm_calls(plan);
  try {
    command();
  } catch (const base::Error& error) {
    problem = error.what();
  } catch (const std::exception& error) {
    problem = broken + std::string(error.what());
  }
  plan.log->add(Call::Kind::Ended, 0, counted_calls(), {}, {}, problem);
  ::_exit(0);
}

}  // namespace

Ended run_child(const CallPlan& plan, const std::function<void()>& command) {
  plan.log->clear();
  const pid_t child = ::fork();
  if (child < 0)
    throw std::runtime_error("no process can be made by fork; mend: end other processes or raise ulimit -u");
  if (child == 0) work(plan, command);
  int status = 0;
  ::waitpid(child, &status, 0);
  Ended ended;
  ended.calls = plan.log->read();
  const bool by_itself = !ended.calls.empty() && ended.calls.back().kind == Call::Kind::Ended;
  if (by_itself) {
    ended.problem = ended.calls.back().bytes;
    ended.counted = static_cast<long>(ended.calls.back().at);
    ended.calls.pop_back();
    ended.how = ended.problem.empty()               ? Ended::How::Done
                : ended.problem.starts_with(broken) ? Ended::How::Broken
                                                    : Ended::How::Refused;
  } else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL &&
             (plan.kind == CallPlan::Kind::Kill || plan.kind == CallPlan::Kind::Tear)) {
    ended.how = Ended::How::Killed;
  } else {
    ended.problem = "the process ended with status " + std::to_string(status);
  }
  return ended;
}

}  // namespace faults
