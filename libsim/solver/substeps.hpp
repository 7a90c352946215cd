#pragma once
/// The number of substeps per frame.

#include <algorithm>
#include <cmath>

namespace sim {

/// Stores a value that each frame measures, and returns the value of two frames ago. The lag is the same on
/// every machine, so that runs are reproducible.
template <class T>
class TwoFramesAgo {
 public:
  /// `first`: the value for the first two frames.
  explicit TwoFramesAgo(T first = {}) : older_(first), newer_(first) {}
  void frame_ended(T value) {
    older_ = newer_;
    newer_ = value;
  }
  T value() const { return older_; }

 private:
  T older_, newer_;
};

/// Inputs of SubstepRule, in SI units.
struct SubstepLimits {
  double frame_dt_s = 0;
  double support_m = 0;          ///< h of the finest particles that the method can hold
  double courant = 0.5;          ///< maximum distance of the fastest particle per substep, as a share of h
  double acceleration_m_s2 = 0;  ///< from gravity and the central force
  /// Maximum distance a dt^2 by which the acceleration a moves a particle in a substep, as a share of h. In
  /// water at rest the projections must push particles back by this distance (docs/decisions.md).
  double push = 0.04;
  int least = 1;
  int most = 1;  ///< >= least
};

/// Chooses the number of substeps so that v dt <= courant h and a dt^2 <= push h. v is the speed of the
/// fastest particle two frames ago, plus the speed that the forces may have added since; a is the
/// acceleration by the forces.
class SubstepRule {
 public:
  SubstepRule() = default;
  /// `fastest_m_s`: the speed assumed for the first two frames.
  SubstepRule(const SubstepLimits& limits, double fastest_m_s) : limits_(limits), fastest_(fastest_m_s) {}

  /// Uses `least` and `most` of `other` from now on. Other limits and the measured speeds do not change.
  void take_bounds(const SubstepRule& other) {
    limits_.least = other.limits_.least;
    limits_.most = other.limits_.most;
  }
  /// Takes the largest speed at the end of a frame, m/s.
  void frame_ended(double fastest_m_s) { fastest_.frame_ended(fastest_m_s); }
  /// Number of substeps that the next frame needs, at least `least`; next() limits it to `most`.
  int wished() const {
    const double speed = fastest_.value() + 2 * limits_.acceleration_m_s2 * limits_.frame_dt_s;
    const double by_way = speed * limits_.frame_dt_s / (limits_.courant * limits_.support_m);
    return std::max(limits_.least, counted(by_way < by_push() ? by_push() : by_way));
  }
  int next() const { return std::min(wished(), limits_.most); }
  /// Number of substeps that a frame needs even if the water is at rest.
  int at_rest() const { return std::max(limits_.least, counted(by_push())); }
  int most() const { return limits_.most; }

 private:
  double by_push() const {
    return limits_.frame_dt_s * std::sqrt(limits_.acceleration_m_s2 / (limits_.push * limits_.support_m));
  }
  /// The bound 1e6 also applies if the speed is not finite; the guards repair such particles.
  static int counted(double steps) { return static_cast<int>(steps < 1e6 ? std::ceil(steps - 1e-9) : 1e6); }

  SubstepLimits limits_;
  TwoFramesAgo<double> fastest_;
};

}  // namespace sim
