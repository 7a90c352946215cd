#pragma once
/// Keeps the frames and the gaze of a running trial without touching the disk between two frames.

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

/// What is not in the store yet.
struct Unwritten {
  std::vector<FrameRecord> frames;
  std::vector<GazeSample> gaze;
};

/// In the background a thread commits what has gathered every half second, so that a killed program loses
/// less than that; the store belongs to that thread until finish(). Otherwise all waits for finish().
class FrameJournal {
 public:
  /// origin: of the gaze that add() is given.
  FrameJournal(Store& store, std::int64_t presentation, std::int64_t start_ns, GazeOrigin origin,
               bool in_background);
  ~FrameJournal();
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;

  /// Takes one frame and the gaze until then, in memory. Throws what stopped the thread, such as a full disk.
  void add(const FrameRecord& frame, const std::vector<GazeSample>& gaze);
  /// Ends the thread, commits the gaze that is left and `last`, and gives back the frames that are not yet in
  /// the store.
  std::vector<FrameRecord> finish(const std::vector<GazeSample>& last);

 private:
  void write_in_background();
  void write_gaze(const std::vector<GazeSample>& gaze);
  void stop();

  Store& store_;
  std::int64_t presentation_, start_ns_;
  GazeOrigin origin_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Unwritten pending_;
  bool stopping_ = false;
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;
  std::thread writer_;
};

}  // namespace study
