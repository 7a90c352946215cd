#pragma once
/// Runs calls that may never return.

#include <chrono>
#include <functional>
#include <memory>

namespace study {

/// Runs calls on a separate thread; the caller waits for each call up to a time limit.
class WatchedThread {
 public:
  WatchedThread();
  /// Ends the thread; a thread that hangs in a call is detached.
  ~WatchedThread();
  WatchedThread(const WatchedThread&) = delete;
  WatchedThread& operator=(const WatchedThread&) = delete;

  /// Returns true if the call returned within `limit`. After false the call still runs, and further calls are
  /// refused. The call must own the memory that it writes to.
  bool run(std::function<void()> call, std::chrono::nanoseconds limit);
  bool hangs() const { return hangs_; }

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  bool hangs_ = false;
};

}  // namespace study
