#pragma once
/// Normalisation of F, the weighted sum of a particle's saliency features (ViP-Fluid Eq. 1), to s in [0, 1]:
/// bounds of F, smoothed over frames. ViP-Fluid 3.2.3 does not define the normalisation.

#include <cstdint>

#include "libsim/exec/histogram.hpp"
#include "libsim/methods/preset.hpp"

namespace sim::SIM_BACKEND {

/// Values of F that become s = 0 and s = 1.
struct SaliencyRange {
  float low, high;
  int known;   ///< 0 before the first usable frame
  int usable;  ///< 0: this frame's finite values, each counted 2^level times, are fewer than two, or its
               ///< bounds differ by less than rounding errors
};

/// Finds exact percentiles of non-negative values by three rounds of histograms over their bits: no sort,
/// robust to outliers, and independent of the order of the values.
class SaliencyNormaliser {
 public:
  /// Share by which the range moves towards a frame's percentiles.
  static constexpr double follow = 0.1;
  /// Updates the range from values[0 .. n-1]; non-finite values are ignored. Percentile: the bounds move
  /// towards the 1st and 98th percentile by `share` (the first frame sets them); value i counts 2^level[i]
  /// times, so that values weigh by mass and the bounds do not depend on the levels. MinMax: the frame's own
  /// bounds. The upper bound is never below `floor`: if nothing is salient, no particle gets s = 1. The host
  /// reads nothing back.
  void update(const Array<float>& values, const std::uint8_t* level, int n, Normalisation reading,
              float share = static_cast<float>(follow), float floor = 0);
  /// In the back end's memory; valid after the first update.
  const SaliencyRange* range() const { return range_.data(); }
  void forget() { range_ = Array<SaliencyRange>(); }

  /// Search state between two rounds, for both bounds.
  struct Selection {
    std::uint32_t prefix[2];
    int rank[2];
    int valid;
  };

  /// Saves or restores the state that lasts beyond a frame (libsim/solver/state_archive.hpp).
  template <class Archive>
  void keep(Archive& archive) {
    archive(range_);
  }

 private:
  HistogramStore histogram_;
  Array<Selection> selections_;
  Array<SaliencyRange> range_;
};

}  // namespace sim::SIM_BACKEND
