#pragma once
/// Pictures of a bake, decoded ahead by a thread of its own, so that showing one costs no decoding.

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "libsim/bake/bake_file.hpp"

namespace sim {

/// One consumer. The BakeReader must have pictures and outlive the ring.
class PictureRing {
 public:
  /// 24 pictures are 0.2 s at the shortest interval of the pilot (8 ms), and 22 MB at 640x360.
  explicit PictureRing(const BakeReader& bake, std::size_t capacity = 24);
  ~PictureRing();
  PictureRing(const PictureRing&) = delete;
  PictureRing& operator=(const PictureRing&) = delete;

  /// Decodes from `frame` on; after the last picture it goes on at `frame` again. Returns when the ring is
  /// full.
  void start(std::int64_t frame);
  /// The picture of `frame`; valid until the next call. Waits for it when it is not decoded yet; a frame that
  /// is not ahead restarts the decoding there. Errors of the file are thrown here, at their frame.
  const BakePicture& take(std::int64_t frame);
  /// How often take() had to wait since start().
  std::int64_t waits() const { return waits_; }

 private:
  struct Slot {
    std::int64_t frame = -1;
    BakePicture picture;
    std::exception_ptr error;
  };

  void decode_loop();
  void fill(Slot& slot, std::int64_t frame);
  void restart_at(std::int64_t frame);
  void drop_front();
  bool comes_later(std::int64_t frame) const;

  const BakeReader& bake_;
  PictureReader reader_;
  std::vector<Slot> slots_;
  std::size_t begin_ = 0;   ///< oldest decoded slot
  std::size_t filled_ = 0;  ///< decoded slots
  bool held_ = false;       ///< the oldest is in the consumer's hands
  std::int64_t next_ = 0;   ///< frame to decode next
  std::int64_t loop_to_ = 0;
  std::uint64_t round_ = 0;  ///< counts restarts, so that a picture of an old round is thrown away
  std::int64_t waits_ = 0;
  bool stop_ = false;
  std::mutex mutex_;
  std::condition_variable decoded_, room_;
  std::thread thread_;
};

}  // namespace sim
