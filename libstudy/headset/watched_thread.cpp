#include "libstudy/headset/watched_thread.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace study {

struct WatchedThread::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::function<void()> call;  ///< empty: nothing to do
  bool ends = false;
  std::thread thread;

  void work() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [&] { return ends || call; });
      if (ends) return;
      lock.unlock();
      call();
      lock.lock();
      call = nullptr;
      changed.notify_all();
    }
  }
};

WatchedThread::WatchedThread() : shared_(std::make_shared<Shared>()) {
  // The thread shares ownership of its state, because it may outlive this object.
  shared_->thread = std::thread([shared = shared_] { shared->work(); });
}

WatchedThread::~WatchedThread() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ends = true;
  }
  shared_->changed.notify_all();
  if (hangs_) {
    shared_->thread.detach();
  } else {
    shared_->thread.join();
  }
}

bool WatchedThread::run(std::function<void()> call, std::chrono::nanoseconds limit) {
  if (hangs_) return false;
  std::unique_lock lock(shared_->mutex);
  shared_->call = std::move(call);
  shared_->changed.notify_all();
  hangs_ = !shared_->changed.wait_for(lock, limit, [&] { return !shared_->call; });
  return !hangs_;
}

}  // namespace study
