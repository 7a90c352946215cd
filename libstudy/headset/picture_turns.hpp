#pragma once
/// Keeps track of which picture is drawn into, waits for its slot, is shown, and is looked at by an onlooker.

#include <cstddef>
#include <cstdint>

namespace study {

/// One side draws and posts, another takes the posted picture and reads it, and a third may look on; all
/// under one lock.
class PictureTurns {
 public:
  /// Number of pictures needed, and one more for an onlooker.
  static constexpr std::size_t count = 3, count_with_onlooker = 4;

  /// Returns a picture to draw into: nobody reads it, and the next post() posts it.
  std::size_t begin() {
    drawn_ = 0;
    while (drawn_ == waiting_ || drawn_ == shown_ || drawn_ == read_ || drawn_ == looked_at_) ++drawn_;
    dropped_ = false;
    return drawn_;
  }
  /// Makes the last begun picture wait, unless it was dropped; it replaces one that waited before.
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
  /// Number of the shown picture, from 1: no two pictures have the same.
  std::uint64_t number() const { return number_; }
  /// Returns the shown picture, which is read from now until the next call.
  std::size_t read() { return read_ = shown_; }
  /// The same for the onlooker, until its next call or look_away().
  std::size_t look() { return looked_at_ = shown_; }
  void look_away() { looked_at_ = none; }
  void clear() { shown_ = waiting_ = none; }
  /// As clear(), and the picture being drawn is never shown.
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
