#include "libsim/foam/motion.hpp"

#include "libsim/foam/water_round.hpp"

namespace sim::SIM_BACKEND {

namespace {

constexpr float earth_gravity = 9.81f;

/// Sums over the water particles that reach a position: rho / rho_0 (`share`), and their velocities and
/// supports, weighted by each particle's part of rho / rho_0.
struct SumWater {
  Vec3 x;
  const Vec4* velocity;
  float share = 0;
  Vec3 momentum{};
  float support = 0;

  SIM_FN void operator()(int j, Vec4 other) {
    const Vec3 offset = x - xyz(other);
    const float r2 = dot(offset, offset);
    if (r2 >= other.w * other.w) return;
    const float weight = mass_of(other.w, 1) * Kernel(other.w).density(r2);
    share += weight;
    momentum += weight * xyz(velocity[j]);
    support += weight * other.w;
  }
};

template <class Bounds>
struct Move {
  const Vec4* water_velocity;
  WaterRound water;
  Bounds bounds;
  FoamRules rules;
  Vec4* place;
  Vec4* velocity;
  FoamLedger* ledger;

  SIM_FN void operator()(int slot) const {
    Vec4 at = place[slot];
    if (!(at.w > 0)) return;
    const Vec3 from = xyz(at);
    SumWater round{.x = from, .velocity = water_velocity};
    water.that_reaches(from, round);
    const float share = filled(round);
    Vec3 v = moved(xyz(velocity[slot]), share, round);
    Vec3 x = fused(from, rules.dt, v);
    if (bounds.project(x, from, 0)) v = (1 / rules.dt) * (x - from);
    if (share >= FoamKinds::spray && share <= FoamKinds::bubble) at.w -= rules.dt;
    const bool left = !all_finite(x) || tank(bounds).through(x);
    if (left || !(at.w > 0)) {
      atomic_add(left ? &ledger->left : &ledger->dissolved, std::uint64_t{1});
      at.w = 0;
    }
    place[slot] = with_w(x, at.w);
    velocity[slot] = with_w(v, share);
  }

  /// rho / rho_0 as if water continued behind walls and inside obstacles.
  SIM_FN float filled(const SumWater& round) const {
    if (!(round.share > 0)) return 0;
    Vec3 unused;
    const float missing = bounds.missing(round.x, round.support / round.share, unused);
    return round.share / at_least(1 - missing, 0.1f);
  }

  SIM_FN Vec3 moved(Vec3 v, float share, const SumWater& round) const {
    if (share < FoamKinds::spray) {
      // Spray: the exact solution for a drag proportional to the speed.
      const float kept = expf(-rules.air_drag * rules.dt);
      const float fall = rules.air_drag * rules.dt > 1e-4f ? (1 - kept) / rules.air_drag : rules.dt;
      return kept * v - fall * rules.gravity.lift();
    }
    const Vec3 carried = (1 / round.share) * round.momentum;
    if (share <= FoamKinds::bubble) return carried;
    // Bubbles: buoyancy accelerates a bubble and its added mass (half of the displaced water's) by 2 g. The
    // drag is chosen so that `rise` is the final speed relative to the water in Earth's gravity.
    const float follows = 1 - expf(-2 * earth_gravity / rules.rise * rules.dt);
    const Vec3 wish = carried + (rules.rise * rules.gravity.strength / earth_gravity) * rules.gravity.up;
    return v + follows * (wish - v);
  }
};

}  // namespace

template <class Bounds>
void move_foam(FoamPool& pool, FoamWaterView water, const Grid& grid, const Bounds& bounds,
               const FoamRules& rules) {
  for_each("move foam", pool.capacity(),
           Move<Bounds>{.water_velocity = water.velocity(),
                        .water = {grid.cells(), water.position()},
                        .bounds = bounds,
                        .rules = rules,
                        .place = pool.place.data(),
                        .velocity = pool.velocity.data(),
                        .ledger = pool.ledger.data()});
}

template void move_foam(FoamPool&, FoamWaterView, const Grid&, const Walls&, const FoamRules&);
template void move_foam(FoamPool&, FoamWaterView, const Grid&, const Solids&, const FoamRules&);

}  // namespace sim::SIM_BACKEND
