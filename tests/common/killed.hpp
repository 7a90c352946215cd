#pragma once
/// Runs work in a process that is killed at its end, so that no destructor runs.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <exception>

namespace test {

/// Runs `work` in a child process, which must end by kill_here(). The test fails if no signal ends the child.
template <class Work>
void killed(const Work& work) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    try {
      work();
    } catch (const std::exception&) {
      ::_exit(1);
    }
    ::_exit(2);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "ended with exit status " << WEXITSTATUS(status);
}

/// Kills the calling process with SIGKILL.
inline void kill_here() { ::kill(::getpid(), SIGKILL); }

}  // namespace test
