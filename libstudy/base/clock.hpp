#pragma once
/// The clock of a session: the real clock of the system, or a virtual clock that jumps to each deadline
/// instead of waiting.

#include <cstdint>

namespace study {

class Clock {
 public:
  virtual ~Clock() = default;
  /// The current time, ns; never decreases. The real clock reads CLOCK_MONOTONIC.
  virtual std::int64_t now_ns() const = 0;
  /// Returns once the clock is at or past deadline_ns. The real clock first sleeps, then spins.
  virtual void wait_until(std::int64_t deadline_ns) = 0;
};

class RealClock final : public Clock {
 public:
  std::int64_t now_ns() const override;
  void wait_until(std::int64_t deadline_ns) override;
};

/// A clock that starts at 0 ns; wait_until() sets it to the deadline instead of waiting.
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
