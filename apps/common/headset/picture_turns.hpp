#pragma once
/// Which picture is drawn into, which waits for its slot, which is shown, and which somebody looks at.

#include <cstddef>

namespace apps {

/// One side draws and posts, another takes what was posted and reads it, and a third may look on; all under
/// one lock.
class PictureTurns {
 public:
  /// Pictures that are needed, and one more for who looks on.
  static constexpr std::size_t count = 3, count_with_onlooker = 4;

  /// To draw into: nobody reads it, and the next post() is of it.
  std::size_t begin() {
    drawn_ = 0;
    while (drawn_ == waiting_ || drawn_ == shown_ || drawn_ == read_ || drawn_ == looked_at_) ++drawn_;
    dropped_ = false;
    return drawn_;
  }
  /// The one that was begun last waits, unless it was dropped; one that waited before never comes on.
  void post() {
    if (!dropped_) waiting_ = drawn_;
  }
  bool waits() const { return waiting_ != none; }
  /// What waits comes on.
  void take() {
    shown_ = waiting_;
    waiting_ = none;
  }
  bool shows() const { return shown_ != none; }
  /// The one that is shown, which is read from now until the next call.
  std::size_t read() { return read_ = shown_; }
  /// The same for who looks on, until the next call or look_away().
  std::size_t look() { return looked_at_ = shown_; }
  void look_away() { looked_at_ = none; }
  void clear() { shown_ = waiting_ = none; }
  /// The same, and what is being drawn never comes on.
  void drop() {
    clear();
    dropped_ = true;
  }

 private:
  static constexpr std::size_t none = count_with_onlooker;
  std::size_t drawn_ = 0, waiting_ = none, shown_ = none, read_ = none, looked_at_ = none;
  bool dropped_ = false;
};

}  // namespace apps
