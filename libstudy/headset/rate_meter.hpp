#pragma once
/// Measures the refresh rate from the predicted times of slots.

#include <cstdint>
#include <optional>
#include <vector>

namespace study {

struct RateChange {
  double from_hz = 0, to_hz = 0;
};

/// Runtimes report wrong first periods, jitter and leave slots out. The rate comes from settled steps between
/// predicted times. The shortest step of which most others are multiples gives the number of periods in each
/// step; the period is the sum of the steps over the number of periods. The first steps never count, nor do
/// slots that only seem to be left out because the rate changes.
class RateMeter {
 public:
  /// Takes the next slot's predicted time. Returns the change once the rate has settled at another value.
  std::optional<RateChange> add(std::int64_t predicted_ns);
  /// Call it when frames stopped: the next time makes no step with the last one.
  void interrupt();
  /// Hz; none until enough steps have settled, and while the rate changes.
  std::optional<double> hz() const;
  /// Number of slots whose predicted time never came, although a later one did; over the whole session.
  std::int64_t dropped() const { return dropped_; }
  /// Number of predicted times that did not go forward.
  std::int64_t repeated() const { return repeated_; }
  /// Number of steps that differ by more than a tenth of a period from a whole number of periods.
  std::int64_t off_grid() const { return off_grid_; }

 private:
  struct Step {
    std::int64_t ns = 0;
    std::int64_t dropped = 0, off_grid = 0;  ///< as counted for this step
  };

  double period_of_latest() const;
  void count(Step& step);
  std::optional<RateChange> settle();

  std::optional<std::int64_t> last_ns_;
  double period_ns_ = 0;                               ///< 0: not settled
  double before_ns_ = 0;                               ///< the last settled period; 0: none
  int steps_ = 0;                                      ///< since frames run
  std::int64_t counted_ns_ = 0, counted_periods_ = 0;  ///< since the rate settled
  std::int64_t dropped_ = 0, repeated_ = 0, off_grid_ = 0;
  std::vector<Step> latest_;
};

}  // namespace study
