#pragma once
/// Buffers the frames, the gaze samples and the headset's slots (its display periods) of a running trial, so
/// that the session's thread need not write them to the disk between two frames.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "libstudy/pacing/pacer.hpp"
#include "libstudy/session/recording.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Buffered records that are not in the store yet.
struct Unwritten {
  std::vector<FrameRecord> frames;
  std::vector<GazeSample> gaze;
  std::vector<ShownSlot> slots;
  std::vector<IpdChange> ipds;
};

/// The session and the presentation (showing of a stimulus) whose records a FrameJournal writes.
struct JournalPlace {
  std::int64_t session = 0, presentation = 0;
  std::int64_t start_ns = 0;  ///< start of the presentation
};

/// Writes the frames, gaze and slots of one presentation to the store. With in_background, a thread commits
/// the buffered records every half second, so that a killed program loses about half a second of records.
/// Without in_background, all records stay in memory until finish().
class FrameJournal {
 public:
  /// origin: source of the gaze samples passed to add().
  FrameJournal(Store& store, const JournalPlace& place, GazeOrigin origin, bool in_background);
  ~FrameJournal();
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;

  /// Buffers one frame, and the gaze and slots recorded up to this frame. Rethrows the error that stopped the
  /// thread, such as a full disk.
  void add(const FrameRecord& frame, const Recorded& recorded);
  /// Ends the thread, commits the buffered gaze, slots and changes of the IPD, and returns the frames that
  /// are not yet in the store. last: what was recorded since the last add(), committed too. Rethrows the
  /// error that stopped the thread.
  std::vector<FrameRecord> finish(const Recorded& last);

 private:
  void write_in_background();
  void write(const Unwritten& recorded);
  void keep(const Recorded& recorded);
  std::optional<std::int64_t> frame_at(std::int64_t predicted_ns) const;
  void stop();

  Store& store_;
  JournalPlace place_;
  GazeOrigin origin_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Unwritten pending_;
  std::vector<std::int64_t> onsets_ns_;  ///< onset of each added frame: predicted, else submission time
  bool stopping_ = false;
  std::atomic<bool> failed_ = false;
  std::exception_ptr failure_;
  std::thread writer_;
};

}  // namespace study
