#pragma once
/// How long each pass of a draw takes: timestamp queries on a GPU, glFinish and the clock on software GL.

#include <string>
#include <vector>

#include "libsim/render/fluid_renderer.hpp"

namespace sim {

/// Needs a current context. When off, every call is free.
class PassTimer {
 public:
  explicit PassTimer(bool on);
  ~PassTimer();
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

  /// Begins a draw and forgets the last one.
  void start();
  /// The pass that ran since the last mark (or start) was `pass`. The same name may come again: times add up.
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
