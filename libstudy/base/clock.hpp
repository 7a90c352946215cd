#pragma once
/// The runner's clock: real, or virtual so that the same code runs without waiting.

#include <cstdint>

namespace study {

class Clock {
 public:
  virtual ~Clock() = default;
  /// Monotonic nanoseconds; CLOCK_MONOTONIC on the real clock.
  virtual std::int64_t now_ns() const = 0;
  /// Returns at deadline_ns or as soon after it as possible (sleeps, then spins); at once if it has passed.
  virtual void wait_until(std::int64_t deadline_ns) = 0;
};

class RealClock final : public Clock {
 public:
  std::int64_t now_ns() const override;
  void wait_until(std::int64_t deadline_ns) override;
};

/// Starts at zero and jumps to each deadline.
class VirtualClock final : public Clock {
 public:
  std::int64_t now_ns() const override { return now_ns_; }
  void wait_until(std::int64_t deadline_ns) override {
    if (deadline_ns > now_ns_) now_ns_ = deadline_ns;
  }

 private:
  std::int64_t now_ns_ = 0;
};

}  // namespace study
