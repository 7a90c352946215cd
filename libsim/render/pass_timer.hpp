#pragma once
/// Durations of a draw's passes: timestamp queries on a GPU, glFinish and the clock on software GL.

#include <string>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"

namespace sim {

/// Times the passes of a draw. Needs a current context. With `on` = false all calls do nothing.
class PassTimer {
 public:
  explicit PassTimer(bool on);
  ~PassTimer();
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

  /// Starts a draw and discards the times of the last draw.
  void start();
  /// Ends a pass that began at the last mark() or start(), and names it. Times of equal names are added.
  void mark(const char* pass);
  std::vector<PassTime> times() const;

 private:
  void stamp();

  bool on_;
  bool software_;
  std::vector<std::string> passes_;
  std::vector<unsigned> queries_;
  std::size_t stamps_ = 0;
  std::vector<double> seconds_;
};

}  // namespace sim
