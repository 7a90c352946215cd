#pragma once
/// Mean and standard deviation of the frame rate. The frame pacing, the study's records and the solver's
/// tolerance tau (the mean frame rate minus the one that is just satisfactory) use these functions.

#include <cstddef>
#include <deque>
#include <span>

namespace stats {

/// The harmonic or the arithmetic mean of the frame rate.
enum class FpsMean { Harmonic, Arithmetic };

/// Moments of the instantaneous frame rate 1/dt over N frames, in frames per second.
struct FpsMoments {
  std::size_t frames = 0;
  double mean = 0;             ///< N / sum(dt): the harmonic mean of 1/dt
  double mean_arithmetic = 0;  ///< mean of 1/dt
  double sd = 0;               ///< population standard deviation of 1/dt: divisor N

  double mean_of(FpsMean kind) const { return kind == FpsMean::Harmonic ? mean : mean_arithmetic; }
};

/// Moments of frame intervals in seconds. Every interval must be positive and finite (std::invalid_argument);
/// an empty span gives zeros.
FpsMoments fps_moments(std::span<const double> intervals_s);

/// Sliding window over the last frames of a running program.
class FpsWindow {
 public:
  /// The window holds at most `capacity` frames. std::invalid_argument if `capacity` is 0.
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
