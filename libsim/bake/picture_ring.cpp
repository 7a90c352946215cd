#include "libsim/bake/picture_ring.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace sim {

PictureRing::PictureRing(const BakeReader& bake, std::size_t capacity)
    : bake_(bake), reader_(bake), slots_(std::max<std::size_t>(capacity, 2)) {
  const auto bytes = static_cast<std::size_t>(bake.header().picture_width_px) *
                     static_cast<std::size_t>(bake.header().picture_height_px) * 4;
  if (bytes == 0) throw std::logic_error("PictureRing: the bake has no pictures");
  // Touched now, so that no page is first seen while frames are shown.
  for (Slot& slot : slots_) slot.picture.rgba.assign(bytes, 0);
  thread_ = std::thread([this] { decode_loop(); });
}

PictureRing::~PictureRing() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  room_.notify_all();
  thread_.join();
}

void PictureRing::start(std::int64_t frame) {
  std::unique_lock lock(mutex_);
  loop_to_ = frame;
  waits_ = 0;
  restart_at(frame);
  decoded_.wait(lock, [this] { return filled_ == slots_.size(); });
}

const BakePicture& PictureRing::take(std::int64_t frame) {
  std::unique_lock lock(mutex_);
  if (held_ && slots_[begin_].frame == frame) return slots_[begin_].picture;
  if (held_) drop_front();
  if (!comes_later(frame)) restart_at(frame);
  while (filled_ == 0 || slots_[begin_].frame != frame) {
    if (filled_ > 0) {
      drop_front();
      continue;
    }
    ++waits_;
    decoded_.wait(lock, [this] { return filled_ > 0; });
  }
  held_ = true;
  if (slots_[begin_].error) std::rethrow_exception(slots_[begin_].error);
  return slots_[begin_].picture;
}

/// A jump forwards of up to two rings is decoded through; any other begins anew at its key picture.
bool PictureRing::comes_later(std::int64_t frame) const {
  for (std::size_t i = 0; i < filled_; ++i) {
    if (slots_[(begin_ + i) % slots_.size()].frame == frame) return true;
  }
  return frame >= next_ && frame - next_ < static_cast<std::int64_t>(2 * slots_.size());
}

void PictureRing::drop_front() {
  begin_ = (begin_ + 1) % slots_.size();
  --filled_;
  held_ = false;
  room_.notify_one();
}

void PictureRing::restart_at(std::int64_t frame) {
  ++round_;
  begin_ = filled_ = 0;
  held_ = false;
  next_ = frame;
  room_.notify_one();
}

void PictureRing::decode_loop() {
  // The thread that shows pictures goes first. Refused only under exotic limits, and then merely not so.
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 5);
  std::unique_lock lock(mutex_);
  while (true) {
    room_.wait(lock, [this] { return stop_ || filled_ < slots_.size(); });
    if (stop_) return;
    Slot& slot = slots_[(begin_ + filled_) % slots_.size()];
    const std::int64_t frame = next_;
    const std::uint64_t round = round_;
    lock.unlock();
    fill(slot, frame);
    lock.lock();
    if (round != round_) continue;
    ++filled_;
    next_ = frame + 1 < bake_.header().frame_count ? frame + 1 : loop_to_;
    decoded_.notify_one();
  }
}

void PictureRing::fill(Slot& slot, std::int64_t frame) {
  slot.frame = frame;
  slot.error = nullptr;
  try {
    const BakePicture& picture = reader_.read(frame);
    slot.picture.facts = picture.facts;
    slot.picture.rgba.assign(picture.rgba.begin(), picture.rgba.end());
  } catch (...) {
    slot.error = std::current_exception();
  }
}

}  // namespace sim
