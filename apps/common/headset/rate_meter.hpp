#pragma once
/// The refresh rate as the predicted times of slots show it.

#include <cstdint>
#include <deque>
#include <optional>

namespace apps {

struct RateChange {
  double from_hz = 0, to_hz = 0;
};

/// Runtimes tell wrong first periods, jitter and drop slots: the rate is the median of settled steps between
/// predicted times. The first steps never count.
class RateMeter {
 public:
  /// Takes the next slot's predicted time; tells when the rate is another than it was.
  std::optional<RateChange> add(std::int64_t predicted_ns);
  /// Hz; empty until enough steps have settled.
  std::optional<double> hz() const;
  std::int64_t steps() const { return steps_; }
  /// Slots that were left out between two that came, since the rate is known.
  std::int64_t dropped() const { return dropped_; }
  /// Predicted times that did not go forward.
  std::int64_t repeated() const { return repeated_; }
  /// Steps that lie more than a tenth of a period beside a whole number of periods, since the rate is known.
  std::int64_t off_grid() const { return off_grid_; }

 private:
  void count(std::int64_t step_ns);

  std::optional<std::int64_t> last_ns_;
  std::int64_t period_ns_ = 0;  ///< 0: not settled
  std::int64_t steps_ = 0, dropped_ = 0, repeated_ = 0, off_grid_ = 0;
  std::deque<std::int64_t> latest_;  ///< steps, ns
};

}  // namespace apps
