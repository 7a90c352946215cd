#include "libsim/activation/percentile_range.hpp"

#include <cstring>

namespace sim::SIM_BACKEND {

namespace {

/// Computes the 1st and the 99th percentile, each interpolated within the bin in which the cumulative count
/// reaches 1 % or 99 % of n.
struct PlaceInBin {
  BinCounts counts;
  ValueRange* now;
  int n;
  SIM_FN void operator()(int at) const {
    place(at, 0.01f, now->low);
    place(at, 0.99f, now->high);
  }
  SIM_FN void place(int at, float q, float& percentile) const {
    const float wanted = q * static_cast<float>(n);
    counts.find(at, 0, static_cast<int>(ceilf(wanted)) - 1, [&](int bin, int before, int here) {
      const float part = (wanted - static_cast<float>(before)) / static_cast<float>(here);
      percentile = ValueCounter::value_at(static_cast<float>(bin) + part);
    });
  }
};

struct Follow {
  const ValueRange* now;
  ValueRange* range;
  float share;
  SIM_FN void operator()(int) const {
    const ValueRange last = *range;
    *range = last.low > last.high ? *now
                                  : ValueRange{last.low + share * (now->low - last.low),
                                               last.high + share * (now->high - last.high)};
  }
};

struct FollowPercentiles {
  ValueRange* now;
  ValueRange* range;
  int n;
  float share;
  template <class Block>
  SIM_FN void operator()(Block block, const BinCounts& counts) const {
    block.each(counts.runs(), PlaceInBin{counts, now, n});
    block.each(1, Follow{now, range, share});
  }
};

/// The bits as an integer: floats >= 0 have the same order as their bits.
SIM_FN int bits_of(float value) {
  int bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

constexpr int values_of_run = 16;
int value_runs(int n) { return (n + values_of_run - 1) / values_of_run; }

struct Extremes {
  const float* values;
  int* least_negated;
  int* largest;
  int n;
  SIM_FN void operator()(int run) const {
    const int end = (run + 1) * values_of_run < n ? (run + 1) * values_of_run : n;
    float low = values[run * values_of_run];
    float high = low;
    for (int i = run * values_of_run; i < end; ++i) {
      low = fminf(low, values[i]);
      high = fmaxf(high, values[i]);
    }
    atomic_max(least_negated, -bits_of(fmaxf(low, 0.0f)));
    atomic_max(largest, bits_of(fmaxf(high, 0.0f)));
  }
};

struct BeginExtremes {
  int* least_negated;
  int* largest;
  SIM_FN void operator()(int) const {
    *least_negated = -2147483647;
    *largest = 0;
  }
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
  now_.resize(1);
  if (range_.size() == 0) range_.from_host({{1, 0}});
}

void PercentileRange::follow_percentiles(int n, float share) {
  ready();
  if (n == 0) return;
  histogram_.take("percentiles", ValueCounter::bins, FollowPercentiles{now_.data(), range_.data(), n, share});
}

void PercentileRange::take_extremes(const Array<float>& values, int n) {
  ready();
  if (n == 0) return;
  extremes_.resize(2);
  int* least_negated = extremes_.data();
  int* largest = extremes_.data() + 1;
  for_each("extremes", 1, BeginExtremes{least_negated, largest});
  for_each("extremes", value_runs(n), Extremes{values.data(), least_negated, largest, n});
  for_each("extremes", 1, TakeExtremes{least_negated, largest, range_.data()});
}

}  // namespace sim::SIM_BACKEND
