#include "libsim/bake/picture_ring.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace sim {

PictureRing::PictureRing(const BakeReader& bake, std::size_t capacity)
    : bake_(bake), reader_(bake), slots_(std::max<std::size_t>(capacity, 2)) {
  const auto bytes = static_cast<std::size_t>(bake.header().picture_width_px) *
                     static_cast<std::size_t>(bake.header().picture_height_px) * 4;
  if (bytes == 0)
    throw std::logic_error("PictureRing: the bake has no pictures; check BakeHeader::has_pictures() first");
  // Write to the memory now, to avoid page faults while pictures are shown.
  for (Slot& each : slots_) each.picture.rgba.assign(bytes, 0);
  thread_ = std::thread([this] { decode_loop(); });
}

PictureRing::~PictureRing() {
  stop_ = true;
  ++calls_;
  calls_.notify_one();
  thread_.join();
}

void PictureRing::start(std::int64_t frame) {
  if (round_ > 0 && expected_ == frame && loop_to_ == frame) return;
  loop_to_ = frame;
  restart_at(frame);
  while (true) {
    const std::uint64_t filled = filled_;
    while (freed_ < filled && slot(freed_).round != round_) drop_front();
    if (filled - freed_ == slots_.size()) break;
    wait_beyond(filled);
  }
  waits_ = 0;
}

const BakePicture& PictureRing::take(std::int64_t frame) {
  if (held_ == frame) return slot(freed_).picture;
  if (held_) drop_front();
  if (!comes_later(frame)) restart_at(frame);
  while (true) {
    if (freed_ == filled_) {
      ++waits_;
      wait_beyond(freed_);
    }
    const Slot& front = slot(freed_);
    if (front.round == round_ && front.frame == frame) break;
    drop_front();
  }
  held_ = frame;
  expected_ = after(frame);
  if (slot(freed_).error) std::rethrow_exception(slot(freed_).error);
  return slot(freed_).picture;
}

/// True if `frame` is one of the next 2 x capacity pictures; take() then drops the pictures before it. For
/// any other frame take() restarts the decoding, which begins at the last key picture up to the frame.
bool PictureRing::comes_later(std::int64_t frame) const {
  std::int64_t next = expected_;
  for (std::size_t i = 0; i < 2 * slots_.size(); ++i, next = after(next)) {
    if (next == frame) return true;
  }
  return false;
}

std::int64_t PictureRing::after(std::int64_t frame) const {
  return frame + 1 < bake_.header().frame_count ? frame + 1 : loop_to_.load();
}

void PictureRing::drop_front() {
  held_.reset();
  ++freed_;
  ++calls_;
  calls_.notify_one();
}

void PictureRing::restart_at(std::int64_t frame) {
  if (held_) drop_front();
  expected_ = frame;
  first_ = frame;
  ++round_;
  ++calls_;
  calls_.notify_one();
}

void PictureRing::wait_beyond(std::uint64_t seen) {
  while (filled_ <= seen) filled_.wait(seen);
}

void PictureRing::decode_loop() {
  // Lowers this thread's priority below that of the thread that shows pictures. If the call fails, decoding
  // works at the usual priority.
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 5);
  std::uint64_t round = 0;
  std::int64_t next = 0;
  while (true) {
    const std::uint64_t calls = calls_;
    if (stop_) return;
    if (round != round_) {
      // If the consumer starts another round between these two reads, the next slots carry the number of an
      // old round, and the consumer drops them.
      round = round_;
      next = first_;
    }
    if (round == 0 || filled_ - freed_ == slots_.size()) {
      calls_.wait(calls);
      continue;
    }
    decode_into(slot(filled_), round, next);
    next = after(next);
    ++filled_;
    filled_.notify_one();
  }
}

void PictureRing::decode_into(Slot& into, std::uint64_t round, std::int64_t frame) {
  into.round = round;
  into.frame = frame;
  into.error = nullptr;
  try {
    const BakePicture& picture = reader_.read(frame);
    into.picture.facts = picture.facts;
    into.picture.rgba.assign(picture.rgba.begin(), picture.rgba.end());
  } catch (...) {
    into.error = std::current_exception();
  }
}

}  // namespace sim
