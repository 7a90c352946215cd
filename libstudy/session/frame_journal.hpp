#pragma once
/// Keeps the frames of a running trial without touching the disk between two frames.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// In the background a thread commits what has gathered every half second, so that a killed program loses
/// less than that; the store belongs to that thread until finish(). Otherwise all frames wait for finish().
class FrameJournal {
 public:
  FrameJournal(Store& store, std::int64_t presentation, std::int64_t start_ns, bool in_background);
  ~FrameJournal();
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;

  /// Takes one frame, in memory. Throws what stopped the thread, such as a full disk.
  void add(const FrameRecord& frame);
  /// Ends the thread and gives back the frames that are not yet in the store.
  std::vector<FrameRecord> finish();

 private:
  void write_in_background();
  void stop();

  Store& store_;
  std::int64_t presentation_, start_ns_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<FrameRecord> pending_;
  bool stopping_ = false;
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;
  std::thread writer_;
};

}  // namespace study
