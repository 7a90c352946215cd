#pragma once
/// A process that is killed when its work is done: what it holds is not put away.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <exception>

namespace test {

/// Does `work` in a child, up to its kill_here(), before which no destructor runs. A failure of the test when
/// it does not come there.
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

/// The end of that work.
inline void kill_here() { ::kill(::getpid(), SIGKILL); }

}  // namespace test
