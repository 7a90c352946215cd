#include "libstudy/session/frame_journal.hpp"

#include <chrono>
#include <utility>

namespace study {

namespace {
constexpr std::chrono::milliseconds interval{500};
constexpr std::size_t usual_frames = 512;
}  // namespace

FrameJournal::FrameJournal(Store& store, std::int64_t presentation, std::int64_t start_ns, GazeOrigin origin,
                           bool in_background)
    : store_(store), presentation_(presentation), start_ns_(start_ns), origin_(origin) {
  pending_.frames.reserve(usual_frames);
  if (in_background) writer_ = std::thread([this] { write_in_background(); });
}

FrameJournal::~FrameJournal() { stop(); }

void FrameJournal::add(const FrameRecord& frame, const std::vector<GazeSample>& gaze) {
  if (failed_) std::rethrow_exception(failure_);
  const std::lock_guard lock(mutex_);
  pending_.frames.push_back(frame);
  pending_.gaze.insert(pending_.gaze.end(), gaze.begin(), gaze.end());
}

void FrameJournal::write_gaze(const std::vector<GazeSample>& gaze) {
  if (!gaze.empty()) store_.add_gaze(presentation_, start_ns_, origin_, gaze);
}

void FrameJournal::write_in_background() {
  Unwritten chunk;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval, [this] { return stopping_; })) {
    chunk = {};
    chunk.frames.reserve(usual_frames);
    std::swap(chunk, pending_);
    lock.unlock();
    try {
      if (!chunk.frames.empty()) store_.add_frames(presentation_, start_ns_, chunk.frames);
      write_gaze(chunk.gaze);
    } catch (...) {
      failure_ = std::current_exception();
      failed_ = true;
      return;
    }
    lock.lock();
  }
}

void FrameJournal::stop() {
  if (!writer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  writer_.join();
}

std::vector<FrameRecord> FrameJournal::finish(const std::vector<GazeSample>& last) {
  stop();
  if (failed_) std::rethrow_exception(failure_);
  pending_.gaze.insert(pending_.gaze.end(), last.begin(), last.end());
  write_gaze(std::exchange(pending_.gaze, {}));
  return std::move(pending_.frames);
}

}  // namespace study
