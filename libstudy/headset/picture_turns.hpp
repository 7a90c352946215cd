#pragma once
/// Keeps track of the pictures that are drawn into, wait for their slot, are shown, or are read by an
/// onlooker.

#include <cstddef>
#include <cstdint>

namespace study {

/// Assigns the pictures of a fixed set to three threads. The drawing thread calls begin() and post(), the
/// slot thread take() and read(), an onlooker look() and look_away(). The callers hold one common lock.
class PictureTurns {
 public:
  /// Number of pictures that are needed without and with an onlooker.
  static constexpr std::size_t count = 3, count_with_onlooker = 4;

  /// Returns a picture to draw into, which no thread reads. The next post() posts it.
  std::size_t begin() {
    drawn_ = 0;
    while (drawn_ == waiting_ || drawn_ == shown_ || drawn_ == read_ || drawn_ == looked_at_) ++drawn_;
    dropped_ = false;
    return drawn_;
  }
  /// Makes the last begun picture wait for its slot, unless the picture was dropped. A picture that still
  /// waits is discarded.
  void post() {
    if (!dropped_) waiting_ = drawn_;
  }
  bool waits() const { return waiting_ != none; }
  /// Shows the waiting picture.
  void take() {
    shown_ = waiting_;
    waiting_ = none;
    ++number_;
  }
  bool shows() const { return shown_ != none; }
  /// Number of the shown picture, counted from 1 by take().
  std::uint64_t number() const { return number_; }
  /// Returns the shown picture and protects it from being drawn into until the next read().
  std::size_t read() { return read_ = shown_; }
  /// As read() for the onlooker: protects the picture until the next look() or look_away().
  std::size_t look() { return looked_at_ = shown_; }
  void look_away() { looked_at_ = none; }
  void clear() { shown_ = waiting_ = none; }
  /// As clear(); the picture that is being drawn will not be shown either.
  void drop() {
    clear();
    dropped_ = true;
  }

 private:
  static constexpr std::size_t none = count_with_onlooker;
  std::size_t drawn_ = 0, waiting_ = none, shown_ = none, read_ = none, looked_at_ = none;
  bool dropped_ = false;
  std::uint64_t number_ = 0;
};

}  // namespace study
