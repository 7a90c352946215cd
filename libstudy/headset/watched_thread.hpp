#pragma once
/// Runs calls that may never return.

#include <chrono>
#include <functional>
#include <memory>

namespace study {

/// Runs calls on its own thread while the caller waits for them, up to a limit.
class WatchedThread {
 public:
  WatchedThread();
  /// Ends the thread; a thread that hangs in a call is detached.
  ~WatchedThread();
  WatchedThread(const WatchedThread&) = delete;
  WatchedThread& operator=(const WatchedThread&) = delete;

  /// Returns true if the call returned in time. After false the thread hangs and takes no further calls; the
  /// call must own the memory that it writes to.
  bool run(std::function<void()> call, std::chrono::nanoseconds limit);
  bool hangs() const { return hangs_; }

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  bool hangs_ = false;
};

}  // namespace study
