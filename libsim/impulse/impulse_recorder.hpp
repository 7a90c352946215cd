#pragma once
/// Records the momentum account of the water (sim::MomentumAccount) while a frame runs. All sums are in fixed
/// point, so that they do not depend on the order of addition.

#include "libsim/impulse/momentum_account.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/particles/walls.hpp"

namespace sim::SIM_BACKEND {

/// Causes of a change of the water's momentum, as the account lists them.
enum class Change { None, Forces, Flow, Levels, Viscosity, Effects, Inherited, Projections, Braked, count };
enum class WallPart { MissingDensity, CoarsePressure, Clamp, count };

/// A gauge in the form that kernels use: its wall, and the gauge's box made infinite across the wall, and
/// beyond each edge of the wall that the box reaches.
struct GaugeBox {
  int wall;
  Vec3 low, high;
  /// Share of the box at - half .. at + half that lies inside the gauge.
  SIM_FN float share(Vec3 at, Vec3 half) const {
    return share_within(at.x, half.x, low.x, high.x) * share_within(at.y, half.y, low.y, high.y) *
           share_within(at.z, half.z, low.z, high.z);
  }
};

/// Pushes of a wall or within a gauge, by cause: mass in m_* (mass of a finest particle) times displacement
/// in m, as integer multiples of `unit`.
struct WallSum {
  std::uint64_t parts[static_cast<int>(WallPart::count)];
  static constexpr float unit = 1.0f / (1ull << 36);
};

/// Records the pushes of walls, for kernels. `sums`: one sum per wall, then one per gauge.
struct WallRecord {
  WallSum* sums;
  const GaugeBox* gauges;
  int gauge_count;
  float finest_support;
  /// Factor on each recorded push; above 1 if later iterations repeat the push (SolverParameters::momentum).
  float times;

  /// Adds a wall's push on a particle, m_* m along the wall's normal; the push is spread over the box at -
  /// half .. at + half.
  SIM_FN void add(int wall, WallPart part, Vec3 at, Vec3 half, float push) const {
    add(sums[wall], part, push);
    for (int k = 0; k < gauge_count; ++k) {
      if (gauges[k].wall == wall) add(sums[wall_count + k], part, push * gauges[k].share(at, half));
    }
  }
  /// Adds a wall's push on a particle of support h, spread over a cube of the particle's spacing h / 2.
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

/// Records a particle that a wall holds back or moves back, as reported by Walls::hold_back and
/// Walls::project.
struct RecordClamp {
  WallRecord to;
  Vec4 particle;
  SIM_FN void body(int, Vec3, Vec3) const {}
  SIM_FN void operator()(int wall, float way) const {
    to.add(wall, WallPart::Clamp, xyz(particle), particle.w,
           mass_units_of(particle.w, to.finest_support) * way);
  }
};

/// Momentum of the water, m_* m/s (m_*: mass of a finest particle): totals, and changes by cause.
struct MomentumSums {
  Momentum now, last, first;  ///< at present, at the last mark() or begin_frame(), at begin_frame()
  Momentum taken;             ///< removed by guards (Guards::braked) up to the last mark()
  Momentum changed[static_cast<int>(Change::count)];
};

class ImpulseRecorder {
 public:
  /// Starts the recording of all later frames. room_m: Scene::room_m. base::Error for a gauge without area on
  /// its wall.
  void begin(const std::vector<Gauge>& gauges, const Vec3d& room_m, float finest_support);
  bool on() const { return on_; }
  /// True while changes of position by walls count as impulses; false during position corrections that do not
  /// change the velocity.
  bool recording() const { return on_ && !paused_; }
  void pause(bool yes) { paused_ = yes; }
  bool paused() const { return paused_; }
  WallRecord record_to(float times = 1);

  void begin_frame(const Particles& particles, const Guards* guards);
  /// Assigns the change of momentum since the last mark() or begin_frame() to the cause `as`; does nothing
  /// for Change::None or while off.
  void mark(Change as, const Particles& particles, const Guards* guards);
  /// Returns the frame's account. `rest_density` in kg/m3; `dt`: duration of a substep, s.
  MomentumAccount end_frame(float rest_density, float dt);

 private:
  void sum_up(const Particles& particles);

  bool on_ = false;
  bool paused_ = false;
  float finest_support_ = 0;
  Array<GaugeBox> gauges_;
  Array<WallSum> walls_;
  Array<MomentumSums> sums_;
};

}  // namespace sim::SIM_BACKEND
