#pragma once
/// Mean and standard deviation of the frame rate. The pacer, the records and the solver's tau all use this
/// definition.

#include <cstddef>
#include <deque>
#include <span>

namespace stats {

/// The mean of the frame rate that defines mu.
enum class FpsMean { Harmonic, Arithmetic };

/// Moments of the instantaneous frame rate 1/dt over N frames, in frames per second.
struct FpsMoments {
  std::size_t frames = 0;
  double mean = 0;  ///< mu = N / sum(dt): the harmonic mean of 1/dt (paper Table 2: 1000 / mean ms)
  double mean_arithmetic = 0;  ///< mean of 1/dt
  double sd =
      0;  ///< delta: population standard deviation of 1/dt (divisor N, around its own arithmetic mean)

  double mean_of(FpsMean kind) const { return kind == FpsMean::Harmonic ? mean : mean_arithmetic; }
};

/// Moments of frame intervals in seconds. Every interval must be positive and finite (std::invalid_argument);
/// an empty span gives zeros.
FpsMoments fps_moments(std::span<const double> intervals_s);

/// Sliding window over the last frames of a running program, at most `capacity` of them.
class FpsWindow {
 public:
  /// capacity >= 1 frames.
  explicit FpsWindow(std::size_t capacity = 30);
  /// interval_s > 0, otherwise std::invalid_argument.
  void push(double interval_s);
  FpsMoments moments() const;
  /// Oldest first, in seconds.
  const std::deque<double>& intervals_s() const { return intervals_s_; }

 private:
  std::size_t capacity_;
  std::deque<double> intervals_s_;
};

}  // namespace stats
