#include "libsim/saliency/normaliser.hpp"

#include <cmath>
#include <cstring>

namespace sim::SIM_BACKEND {

namespace {

using Selection = SaliencyNormaliser::Selection;
constexpr int bits_a_round = 11;
constexpr int bins = 1 << bits_a_round;
constexpr int rounds = 3;     // three rounds cover the 31 bits of a non-negative float
constexpr int trim_low = 1;   // % of the values below the lower bound
constexpr int trim_high = 2;  // % of the values above the upper bound

SIM_FN std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits & 0x7fffffffu;  // without the sign: -0 becomes 0
}
SIM_FN float value_of(std::uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/// For each of the two bounds, a histogram of the next 11 bits of those finite values whose higher bits are
/// the ones found for the bound so far (prefix). A value counts 2^level times.
struct CountBits {
  const float* values;
  const std::uint8_t* level;
  const Selection* selection;
  Histogram histogram;
  int shift;
  SIM_FN void operator()(int i) const {
    if (!std::isfinite(values[i])) return;
    const std::uint64_t bits = bits_of(values[i]);
    for (int end = 0; end < 2; ++end) {
      if (bits >> (shift + bits_a_round) != selection->prefix[end]) continue;
      histogram.add(i, end * bins + static_cast<int>(bits >> shift & (bins - 1u)), 1 << level[i]);
    }
  }
};

/// Finds, for each bound, the bin that contains the wanted rank, and appends the bin's bits to the bound.
/// Each call searches one run of bins.
struct Narrow {
  BinCounts counts;
  const Selection* selection;
  Selection* next;
  int trim_low, trim_high;  ///< %
  bool first;
  SIM_FN void operator()(int at) const {
    constexpr int runs = bins / BinCounts::run;
    const int end = at / runs;
    const int valid = first ? counts.before(runs) : selection->valid;
    if (at == 0) next->valid = valid;
    int rank = selection->rank[end];
    if (first) {
      const std::int64_t last = valid - 1;
      rank = static_cast<int>(end == 0 ? last * trim_low / 100 : last - last * trim_high / 100);
    }
    counts.find(at, end * runs, rank, [&](int bin, int before, int) {
      const auto digits = static_cast<std::uint32_t>(bin - end * bins);
      next->prefix[end] = selection->prefix[end] << bits_a_round | digits;
      next->rank[end] = rank - before;
    });
  }
};

struct FollowRange {
  const Selection* found;
  SaliencyRange* range;
  float share, floor;
  SIM_FN void operator()(int) const {
    const float low = value_of(found->prefix[0]);
    const float high = fmaxf(value_of(found->prefix[1]), floor);
    // A range of the size of rounding errors is meaningless.
    range->usable = found->valid >= 2 && high - low > 1e-6f * high;
    if (!range->usable) return;
    const float step = range->known ? share : 1;
    range->low = step == 1 ? low : range->low + step * (low - range->low);
    range->high = step == 1 ? high : range->high + step * (high - range->high);
    range->known = 1;
  }
};

/// Ends a round of the search; after the last round, moves the range towards the bounds that were found.
struct SelectBins {
  const Selection* selection;
  Selection* next;
  SaliencyRange* range;
  float share, floor;
  int trim_low, trim_high;
  bool first, last;
  template <class Block>
  SIM_FN void operator()(Block block, const BinCounts& counts) const {
    block.each(counts.runs(), Narrow{counts, selection, next, trim_low, trim_high, first});
    if (last) block.each(1, FollowRange{next, range, share, floor});
  }
};

}  // namespace

void SaliencyNormaliser::update(const Array<float>& values, const std::uint8_t* level, int n,
                                Normalisation reading, float share, float floor) {
  if (range_.size() == 0) {
    range_.resize(1);
    range_.zero();
  }
  selections_.resize(rounds + 1);
  selections_.zero();
  const bool percentile = reading == Normalisation::Percentile;
  for (int round = 0; round < rounds; ++round) {
    Selection* selection = selections_.data() + round;
    const int shift = bits_a_round * (rounds - 1 - round);
    for_each("saliency histogram", n,
             CountBits{values.data(), level, selection, histogram_.view(2 * bins), shift});
    histogram_.take("saliency percentiles", 2 * bins,
                    SelectBins{.selection = selection,
                               .next = selection + 1,
                               .range = range_.data(),
                               .share = percentile ? share : 1.0f,
                               .floor = floor,
                               .trim_low = percentile ? trim_low : 0,
                               .trim_high = percentile ? trim_high : 0,
                               .first = round == 0,
                               .last = round == rounds - 1});
  }
}

}  // namespace sim::SIM_BACKEND
