#include "libsim/activation/percentile_range.hpp"

#include <cstring>

namespace sim::SIM_BACKEND {

namespace {

constexpr int octaves = 32;
constexpr int bins_an_octave = 8;
constexpr int bin_count = octaves * bins_an_octave;
/// Histograms side by side, so that threads seldom meet in one bin.
constexpr int copies = 16;
constexpr int run_length = 16;
int runs_of(int n) { return (n + run_length - 1) / run_length; }

struct Count {
  const float* values;
  int* bins;
  int n;

  SIM_FN void operator()(int run) const {
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    int* mine = bins + (run / 32 % copies) * bin_count;
    for (int i = run * run_length; i < end; ++i) atomic_add(&mine[bin_of(values[i])], 1);
  }

  SIM_FN static int bin_of(float value) {
    const float least = ldexpf(1, -octaves / 2);
    const float above = log2f(fmaxf(value, least)) + octaves / 2;
    const int bin = static_cast<int>(above * bins_an_octave);
    return bin < 0 ? 0 : bin < bin_count ? bin : bin_count - 1;
  }
};

struct AddCopies {
  int* bins;
  SIM_FN void operator()(int b) const {
    for (int c = 1; c < copies; ++c) bins[b] += bins[c * bin_count + b];
  }
};

/// One thread: walks to both percentiles and moves the ends.
struct FindPercentiles {
  const int* bins;
  ValueRange* range;
  int n;
  float share;

  SIM_FN void operator()(int) const {
    ValueRange now{0, 0};
    float below = 0;
    for (int b = 0; b < bin_count; ++b) {
      const auto here = static_cast<float>(bins[b]);
      place(0.01f, b, below, here, now.low);
      place(0.99f, b, below, here, now.high);
      below += here;
    }
    const ValueRange last = *range;
    *range = last.low > last.high ? now
                                  : ValueRange{last.low + share * (now.low - last.low),
                                               last.high + share * (now.high - last.high)};
  }

  /// Sets the percentile where the count passes it.
  SIM_FN void place(float q, int b, float below, float here, float& percentile) const {
    const float wanted = q * static_cast<float>(n);
    if (below >= wanted || below + here < wanted) return;
    const float part = (wanted - below) / here;
    percentile = exp2f((static_cast<float>(b) + part) / bins_an_octave - octaves / 2);
  }
};

/// Floats of one sign are ordered as their bits are.
SIM_FN int bits_of(float value) {
  int bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

struct Extremes {
  const float* values;
  int* least_negated;
  int* largest;
  int n;
  SIM_FN void operator()(int run) const {
    const int end = (run + 1) * run_length < n ? (run + 1) * run_length : n;
    float low = values[run * run_length];
    float high = low;
    for (int i = run * run_length; i < end; ++i) {
      low = fminf(low, values[i]);
      high = fmaxf(high, values[i]);
    }
    atomic_max(least_negated, -bits_of(fmaxf(low, 0.0f)));
    atomic_max(largest, bits_of(fmaxf(high, 0.0f)));
  }
};

struct SetLeast {
  int* least_negated;
  SIM_FN void operator()(int) const { *least_negated = -2147483647; }
};

struct TakeExtremes {
  const int* least_negated;
  const int* largest;
  ValueRange* range;
  SIM_FN void operator()(int) const {
    const int low = -*least_negated;
    memcpy(&range->low, &low, sizeof low);
    memcpy(&range->high, largest, sizeof(float));
  }
};

}  // namespace

void PercentileRange::ready() {
  bins_.resize(static_cast<std::size_t>(copies) * bin_count);
  bins_.zero();
  if (range_.size() == 0) range_.from_host({{1, 0}});
}

void PercentileRange::follow_percentiles(const Array<float>& values, int n, float share) {
  ready();
  if (n == 0) return;
  for_each("histogram", runs_of(n), Count{values.data(), bins_.data(), n});
  for_each("add histograms", bin_count, AddCopies{bins_.data()});
  for_each("percentiles", 1, FindPercentiles{bins_.data(), range_.data(), n, share});
}

void PercentileRange::take_extremes(const Array<float>& values, int n) {
  ready();
  if (n == 0) return;
  for_each("extremes", 1, SetLeast{bins_.data()});
  for_each("extremes", runs_of(n), Extremes{values.data(), bins_.data(), bins_.data() + 1, n});
  for_each("extremes", 1, TakeExtremes{bins_.data(), bins_.data() + 1, range_.data()});
}

}  // namespace sim::SIM_BACKEND
