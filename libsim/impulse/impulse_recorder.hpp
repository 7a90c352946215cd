#pragma once
/// Keeps the account of the water's momentum (sim::MomentumAccount) while a frame runs. All sums are in fixed
/// point, so that they do not depend on the order of adding.

#include "libsim/impulse/momentum_account.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/particles/walls.hpp"

namespace sim::SIM_BACKEND {

/// What a change of the water's momentum is counted as.
enum class Change { None, Forces, Flow, Levels, Viscosity, Effects, Inherited, Projections, Braked, count };
enum class WallPart { MissingDensity, CoarsePressure, Clamp, count };

/// A gauge in the solver's numbers: the wall's plane, and a box without end across the wall and where the
/// gauge reaches an edge.
struct GaugeBox {
  int wall;
  Vec3 low, high;
  /// Share of a box about `at` that lies inside.
  SIM_FN float share(Vec3 at, Vec3 half) const {
    return overlap(at.x, half.x, low.x, high.x) * overlap(at.y, half.y, low.y, high.y) *
           overlap(at.z, half.z, low.z, high.z);
  }
  SIM_FN static float overlap(float at, float half, float low, float high) {
    return fmaxf(fminf(at + half, high) - fmaxf(at - half, low), 0.0f) / (2 * half);
  }
};

/// Sums of one place, a wall or a gauge: mass in m_* times way in m.
struct WallSum {
  std::uint64_t parts[static_cast<int>(WallPart::count)];
  static constexpr float unit = 1.0f / (1ull << 36);
};

/// What kernels write to: the walls' sums, then the gauges'.
struct WallListener {
  WallSum* sums;
  const GaugeBox* gauges;
  int gauge_count;
  float finest_support;
  /// Of a push that the projections after it take again, how often it counts in all.
  float times;

  /// `push` in m_* m along the normal, spread over a box about `at`.
  SIM_FN void add(int wall, WallPart part, Vec3 at, Vec3 half, float push) const {
    add(sums[wall], part, push);
    for (int k = 0; k < gauge_count; ++k) {
      if (gauges[k].wall == wall) add(sums[wall_count + k], part, push * gauges[k].share(at, half));
    }
  }
  /// Of a particle of support h, as a cube of its spacing.
  SIM_FN void add(int wall, WallPart part, Vec3 at, float h, float push) const {
    add(wall, part, at, Vec3{h / 4, h / 4, h / 4}, push);
  }

 private:
  SIM_FN void add(WallSum& sum, WallPart part, float push) const {
    const float fixed = rintf(times * push / WallSum::unit);
    if (fixed != 0)
      atomic_add(&sum.parts[static_cast<int>(part)],
                 static_cast<std::uint64_t>(static_cast<std::int64_t>(fixed)));
  }
};

/// A particle that a wall holds back or moves back, as Walls::hold_back and Walls::project tell it.
struct HeardClamp {
  WallListener to;
  Vec4 particle;
  SIM_FN void body(int, Vec3, Vec3) const {}
  SIM_FN void operator()(int wall, float way) const {
    to.add(wall, WallPart::Clamp, xyz(particle), particle.w,
           mass_units_of(particle.w, to.finest_support) * way);
  }
};

/// Momentum over m_*, m/s, as sums and by what changed it.
struct MomentumSums {
  Momentum now, last, first;  ///< this moment, the last mark, the frame's beginning
  Momentum taken;             ///< by guards up to the last mark
  Momentum changed[static_cast<int>(Change::count)];
};

class ImpulseRecorder {
 public:
  /// From now on frames are recorded.
  void begin(const std::vector<Gauge>& gauges, const Vec3d& tank_size_m, float finest_support);
  bool on() const { return on_; }
  /// Is what walls do to places an impulse now? Not while places are mended that become no velocity.
  bool listens() const { return on_ && !deaf_; }
  void listen(bool yes) { deaf_ = !yes; }
  bool deaf() const { return deaf_; }
  WallListener listener(float times = 1);

  void begin_frame(const Particles& particles, const Guards* guards);
  /// Counts what has changed since the last mark; nothing for Change::None and while off.
  void mark(Change as, const Particles& particles, const Guards* guards);
  /// `rest_density` in kg/m3, `dt` of a substep.
  MomentumAccount end_frame(float rest_density, float dt);

 private:
  void sum_up(const Particles& particles);

  bool on_ = false;
  bool deaf_ = false;
  float finest_support_ = 0;
  Array<GaugeBox> gauges_;
  Array<WallSum> walls_;
  Array<MomentumSums> sums_;
};

}  // namespace sim::SIM_BACKEND
