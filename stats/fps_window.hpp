#pragma once
/// Mean and standard deviation of the frame rate. The pacer, the records and the solver's tau all use this
/// definition.

#include <cstddef>
#include <deque>
#include <span>

namespace stats {

/// Which mean of the frame rate is mu: the harmonic or the arithmetic one.
enum class FpsMean { Harmonic, Arithmetic };

/// Moments of the instantaneous frame rate 1/dt over N frames, in frames per second.
struct FpsMoments {
  std::size_t frames = 0;
  double mean = 0;  ///< mu = N / sum(dt): the harmonic mean of 1/dt (paper Table 2: 1000 / mean ms)
  double mean_arithmetic = 0;  ///< mean of 1/dt
  double sd =
      0;  ///< delta: population standard deviation of 1/dt (divisor N, about the arithmetic mean of 1/dt)

  double mean_of(FpsMean kind) const { return kind == FpsMean::Harmonic ? mean : mean_arithmetic; }
};

/// Moments of frame intervals in seconds. Every interval must be positive and finite (std::invalid_argument);
/// an empty span gives zeros.
FpsMoments fps_moments(std::span<const double> intervals_s);

/// Sliding window over the last frames of a running program, at most `capacity` of them.
class FpsWindow {
 public:
  /// The window holds at most `capacity` frames; capacity >= 1 (std::invalid_argument).
  explicit FpsWindow(std::size_t capacity = 30);
  /// Adds the newest frame's interval in seconds and drops the oldest one beyond the capacity.
  /// std::invalid_argument unless the interval is positive and finite.
  void push(double interval_s);
  FpsMoments moments() const;
  /// Frame intervals in seconds, oldest first.
  const std::deque<double>& intervals_s() const { return intervals_s_; }

 private:
  std::size_t capacity_;
  std::deque<double> intervals_s_;
};

}  // namespace stats
