#include "libstudy/session/frame_journal.hpp"

#include <chrono>
#include <utility>

namespace study {

namespace {
constexpr std::chrono::milliseconds interval{500};
constexpr std::size_t usual_frames = 512;
}  // namespace

FrameJournal::FrameJournal(Store& store, std::int64_t presentation, std::int64_t start_ns, bool in_background)
    : store_(store), presentation_(presentation), start_ns_(start_ns) {
  pending_.reserve(usual_frames);
  if (in_background) writer_ = std::thread([this] { write_in_background(); });
}

FrameJournal::~FrameJournal() { stop(); }

void FrameJournal::add(const FrameRecord& frame) {
  if (failed_) std::rethrow_exception(failure_);
  const std::lock_guard lock(mutex_);
  pending_.push_back(frame);
}

void FrameJournal::write_in_background() {
  std::vector<FrameRecord> chunk;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval, [this] { return stopping_; })) {
    chunk.clear();
    chunk.reserve(usual_frames);
    std::swap(chunk, pending_);
    lock.unlock();
    try {
      if (!chunk.empty()) store_.add_frames(presentation_, start_ns_, chunk);
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

std::vector<FrameRecord> FrameJournal::finish() {
  stop();
  if (failed_) std::rethrow_exception(failure_);
  return std::move(pending_);
}

}  // namespace study
