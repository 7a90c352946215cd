#pragma once
/// The clock by which a session runs: a real one, or a virtual one with which the same code never waits.

#include <cstdint>

namespace study {

class Clock {
 public:
  virtual ~Clock() = default;
  /// The current time, ns; never decreases. The real clock reads CLOCK_MONOTONIC.
  virtual std::int64_t now_ns() const = 0;
  /// Returns at deadline_ns or as soon after it as possible; at once if deadline_ns has passed. The real
  /// clock sleeps first, then spins.
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
