#pragma once
/// How many substeps a frame takes.

#include <algorithm>
#include <array>
#include <cmath>

namespace sim {

/// What the number follows from. SI units.
struct SubstepLimits {
  double frame_dt_s = 0;
  double support_m = 0;  ///< h of the finest particles that the method can hold
  double courant = 0.5;  ///< way of the fastest particle in a substep at most, as a share of h
  double gravity_m_s2 = 0;
  int least = 1;
  int most = 1;  ///< >= least
};

/// Follows the fastest particle: v dt <= courant h. Frame n goes by the speeds at the end of frame n - 2, whose
/// read-back need not be waited for, and by what gravity may have added since. The lag is the same on every
/// machine, so that runs repeat.
class SubstepRule {
 public:
  SubstepRule() = default;
  /// `fastest_m_s`: the speed that the first two frames go by.
  SubstepRule(const SubstepLimits& limits, double fastest_m_s) : limits_(limits) {
    fastest_.fill(fastest_m_s);
  }

  /// Takes the largest speed at the end of a frame, m/s.
  void frame_ended(double fastest_m_s) {
    fastest_[0] = fastest_[1];
    fastest_[1] = fastest_m_s;
  }
  /// Substeps that the next frame asks for; past `most` it is larger than what next() allows.
  int wished() const {
    const double speed = fastest_[0] + 2 * limits_.gravity_m_s2 * limits_.frame_dt_s;
    const double steps = speed * limits_.frame_dt_s / (limits_.courant * limits_.support_m);
    // Also where the speed is not finite, which the guards mend.
    const double counted = steps < 1e6 ? std::ceil(steps - 1e-9) : 1e6;
    return std::max(limits_.least, static_cast<int>(counted));
  }
  int next() const { return std::min(wished(), limits_.most); }
  const std::array<double, 2>& speeds() const { return fastest_; }

 private:
  SubstepLimits limits_;
  std::array<double, 2> fastest_{};  ///< of the last two frames, the older one first
};

}  // namespace sim
