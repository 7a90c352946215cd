#pragma once
/// Calls that may never come back.

#include <chrono>
#include <functional>
#include <memory>

namespace apps {

/// Runs calls on a thread of its own while the caller waits for them, up to a limit.
class WatchedThread {
 public:
  WatchedThread();
  /// Ends the thread; one that hangs in a call is left to itself.
  ~WatchedThread();
  WatchedThread(const WatchedThread&) = delete;
  WatchedThread& operator=(const WatchedThread&) = delete;

  /// True when the call came back in time. After a false the thread hangs and takes no further call; the call
  /// must own what it writes to.
  bool run(std::function<void()> call, std::chrono::nanoseconds limit);
  bool hangs() const { return hangs_; }

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  bool hangs_ = false;
};

}  // namespace apps
