#pragma once
/// Measures the refresh rate from the predicted times of slots.

#include <cstdint>
#include <optional>
#include <vector>

namespace study {

struct RateChange {
  double from_hz = 0, to_hz = 0;
};

/// Measures the refresh rate from the steps between predicted times of slots, because runtimes report wrong
/// periods at first, jitter, and leave slots out. The number of periods in a step is its ratio to the unit,
/// rounded. The period is the sum of the steps divided by the sum of these numbers. The unit is the reported
/// period, else the period so far, else the shortest step of which most others are multiples. Steps that are
/// multiples of the unit are slots that were left out and never a new rate: a runtime that shows every other
/// slot keeps its rate. The first 8 steps after frames begin do not count. During a change of the rate,
/// dropped() and off_grid() count steps by the old rate; these counts are subtracted when the change is
/// detected.
class RateMeter {
 public:
  /// The runtime says that the rate is `hz` from now on. Steps that do not fit do not change the rate then,
  /// unless doubt() was called.
  void report(double hz);
  /// True once the steps have not fitted the reported rate for 64 slots. Then call report() if the runtime
  /// reports another rate by now, else doubt().
  bool contradicted() const { return misfits_ >= most_misfits; }
  /// Forgets the reported rate, if no step ever fitted it.
  void doubt();
  /// Adds the predicted time of the next slot. Returns the change of the rate once it has settled at another
  /// value; none while a rate is reported.
  std::optional<RateChange> add(std::int64_t predicted_ns);
  /// Call it when frames stopped: the interval until the next predicted time is no step.
  void interrupt();
  /// The measured rate, Hz; none before 16 steps were measured, and while the rate changes.
  std::optional<double> hz() const;
  /// Number of slots that the runtime left out between two predicted times, over the whole session.
  std::int64_t dropped() const { return dropped_; }
  /// Number of predicted times that were not later than the time before.
  std::int64_t repeated() const { return repeated_; }
  /// Number of steps that differ by more than a tenth of a period from a whole number of periods.
  std::int64_t off_grid() const { return off_grid_; }

 private:
  struct Step {
    std::int64_t ns = 0;
    std::int64_t dropped = 0, off_grid = 0;  ///< counts of this step
  };

  static constexpr int most_misfits = 64;

  std::optional<double> period_in(double unit_ns, double share) const;
  double period_of_latest() const;
  bool fits(double period_ns) const;
  void forget_latest();
  void count(Step& step);
  void settle_at(double period_ns);
  std::optional<RateChange> settle();

  std::optional<std::int64_t> last_ns_;
  double period_ns_ = 0;                               ///< 0: not settled
  double before_ns_ = 0;                               ///< the last settled period; 0: none
  double reported_ns_ = 0;                             ///< the reported period; 0: none
  int misfits_ = 0;                                    ///< slots in a row that did not fit reported_ns_
  int steps_ = 0;                                      ///< number of steps since frames began
  std::int64_t counted_ns_ = 0, counted_periods_ = 0;  ///< sums over the steps since the rate settled
  std::int64_t dropped_ = 0, repeated_ = 0, off_grid_ = 0;
  std::vector<Step> latest_;
};

}  // namespace study
