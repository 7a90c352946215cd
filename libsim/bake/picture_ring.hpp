#pragma once
/// Pictures of a bake, decoded in advance by a separate thread, so that showing a picture needs no decoding.

#include <atomic>
#include <cstdint>
#include <exception>
#include <optional>
#include <thread>
#include <vector>

#include "libsim/bake/bake_file.hpp"

namespace sim {

/// Ring buffer of decoded pictures for one consumer thread. The BakeReader must have pictures and outlive the
/// ring. Taking a ready picture takes no lock: a preempted decoding thread never blocks the consumer.
class PictureRing {
 public:
  /// `capacity`: number of pictures; less than 2 counts as 2. 24 pictures last 0.2 s if each is shown for 8
  /// ms, and take 22 MB at 640 x 360 px.
  explicit PictureRing(const BakeReader& bake, std::size_t capacity = 24);
  ~PictureRing();
  PictureRing(const PictureRing&) = delete;
  PictureRing& operator=(const PictureRing&) = delete;

  /// Decodes from `frame` on; after the last picture it continues at `frame` again. Returns when the ring is
  /// full. Does nothing if `frame` is already the frame to be taken next, and also the one at which decoding
  /// continues after the last picture.
  void start(std::int64_t frame);
  /// The picture of `frame`; valid until the next call. Waits if it is not decoded yet. If `frame` is not
  /// among the next 2 x capacity pictures, decoding restarts at `frame`. A picture that cannot be read throws
  /// its error here, when its frame is taken.
  const BakePicture& take(std::int64_t frame);
  /// Number of times that take() had to wait since the last start() that restarted the decoding.
  std::int64_t waits() const { return waits_; }

 private:
  struct Slot {
    std::uint64_t round = 0;
    std::int64_t frame = -1;
    BakePicture picture;
    std::exception_ptr error;
  };

  // Functions of the decoding thread.
  void decode_loop();
  void decode_into(Slot& into, std::uint64_t round, std::int64_t frame);

  // Functions of the consumer thread.
  void restart_at(std::int64_t frame);
  void drop_front();
  /// Waits until filled_ exceeds `seen`.
  void wait_beyond(std::uint64_t seen);
  bool comes_later(std::int64_t frame) const;
  std::int64_t after(std::int64_t frame) const;
  Slot& slot(std::uint64_t count) { return slots_[count % slots_.size()]; }
  const Slot& slot(std::uint64_t count) const { return slots_[count % slots_.size()]; }

  const BakeReader& bake_;
  PictureReader reader_;
  std::vector<Slot> slots_;

  // Numbers of slots filled and released since construction; filled_ - freed_ slots contain pictures. Each
  // counter is written by one thread only.
  std::atomic<std::uint64_t> filled_ = 0;
  std::atomic<std::uint64_t> freed_ = 0;
  // The consumer's request. Each restart begins a new round, with number round_, at frame first_. After the
  // last frame the round continues at loop_to_. Slots of earlier rounds are dropped.
  std::atomic<std::uint64_t> round_ = 0;
  std::atomic<std::int64_t> first_ = 0;
  std::atomic<std::int64_t> loop_to_ = 0;
  /// Incremented for every change that the decoding thread must notice.
  std::atomic<std::uint64_t> calls_ = 0;
  std::atomic<bool> stop_ = false;

  /// The frame whose picture the consumer has now, in slot freed_; none = the consumer has no picture.
  std::optional<std::int64_t> held_;
  std::int64_t expected_ = 0;  ///< next frame of this round that the consumer has not received
  std::int64_t waits_ = 0;
  std::thread thread_;
};

}  // namespace sim
