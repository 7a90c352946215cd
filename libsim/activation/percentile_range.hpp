#pragma once
/// The range of a quantity >= 0 over all particles: percentiles, found without sorting and smoothed over
/// frames, or the minimum and maximum.

#include <cmath>

#include "libsim/exec/histogram.hpp"
#include "libsim/exec/vec.hpp"

namespace sim::SIM_BACKEND {

/// Bounds for normalising a quantity; low > high before the first update.
struct ValueRange {
  float low, high;

  /// Maps low to 0 and high to 1, linearly and clamped; every value to 1 if high is not above low.
  SIM_FN float normalised(float value) const {
    if (!(high > low)) return 1;
    return at_most(at_least((value - low) / (high - low), 0.0f), 1.0f);
  }
};

/// Counts values in a logarithmic histogram, for kernels; without a histogram it counts nothing.
struct ValueCounter {
  Histogram histogram{nullptr, 0};

  /// Counts the i-th value.
  SIM_FN void add(int i, float value) const {
    if (histogram.counts) histogram.add(i, bin_of(value), 1);
  }

  static constexpr int octaves = 32;
  static constexpr int bins_an_octave = 8;
  static constexpr int bins = octaves * bins_an_octave;
  SIM_FN static int bin_of(float value) {
    const float least = ldexpf(1, -octaves / 2);
    const float above = log2f(fmaxf(value, least)) + octaves / 2;
    const int bin = static_cast<int>(above * bins_an_octave);
    return bin < 0 ? 0 : bin < bins ? bin : bins - 1;
  }
  /// The value at a distance of `at` bins from the start of the first bin; `at` may be fractional.
  SIM_FN static float value_at(float at) { return exp2f(at / bins_an_octave - octaves / 2); }
};

/// The range and the counts are stored on the device. The histogram counts values below 2^-16 as 2^-16, and
/// values above 2^16 as 2^16.
class PercentileRange {
 public:
  /// The counter for the pass that measures the values; follow_percentiles() then evaluates and resets the
  /// counts.
  ValueCounter counter() { return {histogram_.view(ValueCounter::bins)}; }
  /// Moves both bounds by `share` towards the 1st and 99th percentile of the n values counted by counter();
  /// sets them directly the first time. Percentiles are exact to an eighth of an octave (9 %). n = 0 changes
  /// nothing.
  void follow_percentiles(int n, float share);
  /// Sets the bounds to the minimum and maximum of the first n values. n = 0 changes nothing.
  void take_extremes(const Array<float>& values, int n);

  const ValueRange* range() const { return range_.data(); }
  /// Copies the range to the host (a synchronisation).
  ValueRange read() const { return range_.to_host()[0]; }
  /// Saves or restores the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(range_);
  }

 private:
  void ready();

  HistogramStore histogram_;
  Array<int> extremes_;
  Array<ValueRange> now_, range_;
};

}  // namespace sim::SIM_BACKEND
