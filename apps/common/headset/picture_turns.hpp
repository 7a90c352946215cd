#pragma once
/// Which of three pictures is drawn into, which waits for its slot, and which is shown.

#include <cstddef>

namespace apps {

/// One side draws and posts, another takes what was posted and reads it; both under one lock.
class PictureTurns {
 public:
  static constexpr std::size_t count = 3;

  /// To draw into: nobody reads it, and the next post() is of it.
  std::size_t begin() {
    drawn_ = 0;
    while (drawn_ == waiting_ || drawn_ == shown_ || drawn_ == read_) ++drawn_;
    return drawn_;
  }
  /// The one that was begun last waits; one that waited before never comes on.
  void post() { waiting_ = drawn_; }
  bool waits() const { return waiting_ != none; }
  /// What waits comes on.
  void take() {
    shown_ = waiting_;
    waiting_ = none;
  }
  bool shows() const { return shown_ != none; }
  /// The one that is shown, which is read from now until the next call.
  std::size_t read() { return read_ = shown_; }
  void clear() { shown_ = waiting_ = none; }

 private:
  static constexpr std::size_t none = count;
  std::size_t drawn_ = 0, waiting_ = none, shown_ = none, read_ = none;
};

}  // namespace apps
