#include "libstudy/session/frame_journal.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace study {

namespace {
constexpr std::chrono::milliseconds interval{500};
constexpr std::size_t usual_frames = 512;
}  // namespace

FrameJournal::FrameJournal(Store& store, const JournalPlace& place, GazeOrigin origin, bool in_background)
    : store_(store), place_(place), origin_(origin) {
  pending_.frames.reserve(usual_frames);
  if (in_background) writer_ = std::thread([this] { write_in_background(); });
}

FrameJournal::~FrameJournal() { stop(); }

void FrameJournal::add(const FrameRecord& frame, const Recorded& recorded) {
  if (failed_) std::rethrow_exception(failure_);
  const std::lock_guard lock(mutex_);
  pending_.frames.push_back(frame);
  onsets_ns_.push_back(placed_ns(frame.times, TimingGrade::Compositor));
  keep(recorded);
}

void FrameJournal::keep(const Recorded& recorded) {
  pending_.gaze.insert(pending_.gaze.end(), recorded.gaze.begin(), recorded.gaze.end());
  pending_.ipds.insert(pending_.ipds.end(), recorded.ipds.begin(), recorded.ipds.end());
  for (const SlotRecord& slot : recorded.slots) pending_.slots.push_back({slot, frame_at(slot.predicted_ns)});
}

std::optional<std::int64_t> FrameJournal::frame_at(std::int64_t predicted_ns) const {
  const auto after = std::upper_bound(onsets_ns_.begin(), onsets_ns_.end(), predicted_ns);
  if (after == onsets_ns_.begin()) return {};
  return after - onsets_ns_.begin() - 1;
}

void FrameJournal::write(const Unwritten& recorded) {
  if (!recorded.slots.empty()) store_.add_slots(place_.presentation, place_.start_ns, recorded.slots);
  for (const IpdChange& change : recorded.ipds)
    store_.add_ipd(place_.session, change.clock_ns, change.ipd_mm);
  if (!recorded.gaze.empty()) store_.add_gaze(place_.presentation, place_.start_ns, origin_, recorded.gaze);
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
      if (!chunk.frames.empty()) store_.add_frames(place_.presentation, place_.start_ns, chunk.frames);
      write(chunk);
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

std::vector<FrameRecord> FrameJournal::finish(const Recorded& last) {
  stop();
  if (failed_) std::rethrow_exception(failure_);
  keep(last);
  Unwritten left = std::exchange(pending_, {});
  write(left);
  return std::move(left.frames);
}

}  // namespace study
