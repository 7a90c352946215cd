#include "libsim/saliency/normaliser.hpp"

#include <cmath>
#include <cstring>

namespace sim::SIM_BACKEND {

namespace {

using Selection = SaliencyNormaliser::Selection;
constexpr int bins = SaliencyNormaliser::bins;
constexpr int copies = SaliencyNormaliser::copies;
constexpr float follow = 0.1f;
constexpr int trim_low = 1;  // %
constexpr int trim_high = 2;

SIM_FN std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits & 0x7fffffffu;  // -0 is 0
}
SIM_FN float value_of(std::uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/// Counts the next eight bits of the values whose higher bits are those of each end.
struct CountBits {
  const float* values;
  const std::uint8_t* level;
  const Selection* selection;
  int* histograms;
  int shift;
  SIM_FN void operator()(int i) const {
    if (!std::isfinite(values[i])) return;
    const std::uint64_t bits = bits_of(values[i]);
    int* own = histograms + (i / 256 % copies) * 2 * bins;
    for (int end = 0; end < 2; ++end) {
      if (bits >> (shift + 8) != selection->prefix[end]) continue;
      atomic_add(&own[end * bins + static_cast<int>(bits >> shift & 255u)], 1 << level[i]);
    }
  }
};

/// Adds the copies and clears them for the next round.
struct AddCopies {
  int* histograms;
  int* totals;
  SIM_FN void operator()(int b) const {
    int sum = 0;
    for (int c = 0; c < copies; ++c) {
      sum += histograms[c * 2 * bins + b];
      histograms[c * 2 * bins + b] = 0;
    }
    totals[b] = sum;
  }
};

/// The bin that holds the wanted rank narrows the search; one of an end's 256 bins does.
struct SelectBin {
  const int* totals;
  const Selection* selection;
  Selection* next;
  int trim_low, trim_high;  ///< %
  bool first;
  SIM_FN void operator()(int b) const {
    const int end = b / bins;
    const int* counts = totals + end * bins;
    int before = 0;
    int all = 0;
    for (int k = 0; k < bins; ++k) {
      before += k < b % bins ? counts[k] : 0;
      all += counts[k];
    }
    const int valid = first ? all : selection->valid;
    if (b == 0) next->valid = valid;
    int rank = selection->rank[end];
    if (first) {
      const std::int64_t last = valid - 1;
      rank = static_cast<int>(end == 0 ? last * trim_low / 100 : last - last * trim_high / 100);
    }
    if (rank < before || rank >= before + counts[b % bins]) return;
    next->prefix[end] = selection->prefix[end] << 8 | static_cast<std::uint32_t>(b % bins);
    next->rank[end] = rank - before;
  }
};

struct FollowRange {
  const Selection* found;
  SaliencyRange* range;
  float share, floor;
  SIM_FN void operator()(int) const {
    const float low = value_of(found->prefix[0]);
    const float high = fmaxf(value_of(found->prefix[1]), floor);
    // A spread of rounding errors tells nothing.
    range->usable = found->valid >= 2 && high - low > 1e-6f * high;
    if (!range->usable) return;
    const float step = range->known ? share : 1;
    range->low = step == 1 ? low : range->low + step * (low - range->low);
    range->high = step == 1 ? high : range->high + step * (high - range->high);
    range->known = 1;
  }
};

}  // namespace

void SaliencyNormaliser::update(const Array<float>& values, const std::uint8_t* level, int n,
                                Normalisation reading, float floor) {
  if (range_.size() == 0) {
    range_.resize(1);
    range_.zero();
  }
  if (histograms_.size() == 0) {
    histograms_.resize(2 * bins * copies);
    histograms_.zero();
    totals_.resize(2 * bins);
    selections_.resize(rounds + 1);
  }
  const bool percentile = reading == Normalisation::Percentile;
  selections_.zero();
  for (int round = 0; round < rounds; ++round) {
    const Selection* selection = selections_.data() + round;
    for_each("saliency histogram", n,
             CountBits{values.data(), level, selection, histograms_.data(), 8 * (rounds - 1 - round)});
    for_each("saliency histogram sum", 2 * bins, AddCopies{histograms_.data(), totals_.data()});
    for_each("saliency percentile", 2 * bins,
             SelectBin{totals_.data(), selection, selections_.data() + round + 1, percentile ? trim_low : 0,
                       percentile ? trim_high : 0, round == 0});
  }
  for_each("saliency range", 1,
           FollowRange{selections_.data() + rounds, range_.data(), percentile ? follow : 1.0f, floor});
}

}  // namespace sim::SIM_BACKEND
