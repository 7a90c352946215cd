#pragma once
/// The refresh rate as the predicted times of slots show it.

#include <cstdint>
#include <optional>
#include <vector>

namespace apps {

struct RateChange {
  double from_hz = 0, to_hz = 0;
};

/// Runtimes tell wrong first periods, jitter and leave slots out. The rate comes from settled steps between
/// predicted times: the shortest of which most are multiples says how many periods each of them holds, their
/// sum over that count is the period. The first steps never count, and what a change of the rate seems to
/// leave out does not either.
class RateMeter {
 public:
  /// Takes the next slot's predicted time. Tells when the rate has become another than it was.
  std::optional<RateChange> add(std::int64_t predicted_ns);
  /// The next time is no step from the last one: no frames ran between them.
  void interrupt();
  /// Hz; empty until enough steps have settled, and while the rate changes.
  std::optional<double> hz() const;
  /// Slots that were left out between two that came.
  std::int64_t dropped() const { return dropped_; }
  /// Predicted times that did not go forward.
  std::int64_t repeated() const { return repeated_; }
  /// Steps that lie more than a tenth of a period beside a whole number of periods.
  std::int64_t off_grid() const { return off_grid_; }

 private:
  struct Step {
    std::int64_t ns = 0;
    std::int64_t dropped = 0, off_grid = 0;  ///< as it was counted
  };

  double period_of_latest() const;
  void count(Step& step);
  std::optional<RateChange> settle();

  std::optional<std::int64_t> last_ns_;
  double period_ns_ = 0;                               ///< 0: not settled
  double before_ns_ = 0;                               ///< the last that was settled; 0: none was
  int steps_ = 0;                                      ///< since frames run
  std::int64_t counted_ns_ = 0, counted_periods_ = 0;  ///< since it was settled
  std::int64_t dropped_ = 0, repeated_ = 0, off_grid_ = 0;
  std::vector<Step> latest_;
};

}  // namespace apps
