#pragma once
/// How many substeps a frame takes.

#include <algorithm>
#include <cmath>

namespace sim {

/// What a frame goes by that was measured at the end of the frame before last: its read-back need not be
/// waited for. The lag is the same on every machine, so that runs repeat.
template <class T>
class TwoFramesAgo {
 public:
  /// `first`: what the first two frames go by.
  explicit TwoFramesAgo(T first = {}) : older_(first), newer_(first) {}
  void frame_ended(T value) {
    older_ = newer_;
    newer_ = value;
  }
  T value() const { return older_; }

 private:
  T older_, newer_;
};

/// What the number follows from. SI units.
struct SubstepLimits {
  double frame_dt_s = 0;
  double support_m = 0;          ///< h of the finest particles that the method can hold
  double courant = 0.5;          ///< way of the fastest particle in a substep at most, as a share of h
  double acceleration_m_s2 = 0;  ///< by gravity and the central force
  int least = 1;
  int most = 1;  ///< >= least
};

/// Follows the fastest particle: v dt <= courant h, by its speed two frames ago and what the forces may
/// have added since.
class SubstepRule {
 public:
  SubstepRule() = default;
  /// `fastest_m_s`: the speed that the first two frames go by.
  SubstepRule(const SubstepLimits& limits, double fastest_m_s) : limits_(limits), fastest_(fastest_m_s) {}

  /// From now on as many as the other allows, by the speeds that this one has seen.
  void take_bounds(const SubstepRule& other) {
    limits_.least = other.limits_.least;
    limits_.most = other.limits_.most;
  }
  /// Takes the largest speed at the end of a frame, m/s.
  void frame_ended(double fastest_m_s) { fastest_.frame_ended(fastest_m_s); }
  /// Substeps that the next frame asks for; past `most` it is larger than what next() allows.
  int wished() const {
    const double speed = fastest_.value() + 2 * limits_.acceleration_m_s2 * limits_.frame_dt_s;
    const double steps = speed * limits_.frame_dt_s / (limits_.courant * limits_.support_m);
    // Also where the speed is not finite, which the guards mend.
    const double counted = steps < 1e6 ? std::ceil(steps - 1e-9) : 1e6;
    return std::max(limits_.least, static_cast<int>(counted));
  }
  int next() const { return std::min(wished(), limits_.most); }

 private:
  SubstepLimits limits_;
  TwoFramesAgo<double> fastest_;
};

}  // namespace sim
