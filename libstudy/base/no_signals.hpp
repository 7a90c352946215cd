#pragma once
/// Keeps signals away from a thread.

#include <pthread.h>
#include <signal.h>

namespace study {

/// While this object exists, the calling thread takes no signals, and neither do threads that it starts, for
/// good: signals are for the session's thread. A write to a closed pipe then fails instead of raising
/// SIGPIPE.
class NoSignals {
 public:
  NoSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~NoSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  NoSignals(const NoSignals&) = delete;
  NoSignals& operator=(const NoSignals&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace study
