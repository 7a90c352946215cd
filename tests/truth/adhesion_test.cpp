/// Adhesion measured back from the contact angle of drops without gravity: W = sigma (1 + cos theta), Young
/// and Dupre.

#include "libsim/scene/effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

#define NEEDS_EFFECTS \
  if (!sim::has_effects()) GTEST_SKIP() << "built with -DVIP_EFFECTS=OFF"

constexpr double d = 0.05;  // of level 0
constexpr double rho = 1000;
constexpr double tension = 10;

/// Half a ball on the floor, in a tank six radii wide.
struct Drop {
  double share = 1.2;                          ///< W / sigma
  double spacings = 8;                         ///< of the start's level, in its radius
  int level = 0;                               ///< of the start
  MethodKind method = MethodKind::HiRes;       ///< that holds this level
  std::optional<sim::TargetRegion> targets{};  ///< in radii, from the middle of its base
  double beta = 1;
  double periods = 4;  ///< of a ball of this radius that swings
  Backend backend = Backend::Cpu;

  double spacing() const { return d * std::cbrt(1 << level); }
  double radius() const { return spacings * spacing(); }
  double period() const { return 2 * pi / std::sqrt(8 * tension / (rho * std::pow(radius(), 3))); }
  /// A period: substeps of at most an eighth of sqrt(rho d^3 / sigma).
  int frames() const { return static_cast<int>(std::ceil(2.22 * std::pow(spacings, 1.5) * 8)); }
};

std::unique_ptr<sim::Simulation> start_of(const Drop& drop) {
  const double width = 6 * drop.radius();
  auto scene = fluid_test::tank({width, width, width}, {width, width, width});
  scene.gravity_m_s2 = 0;
  scene.min_substeps = 1;
  scene.viscosity_m2_s = 0.02 * drop.radius() * drop.radius() * 2 * pi / drop.period();
  scene.frame_dt_s = drop.period() / drop.frames();
  scene.effects = {{EffectKind::Cohesion, tension}, {EffectKind::Adhesion, drop.share * tension}};
  State start = lattice(
      drop.spacing(), scene.tank_size_m,
      [&](const Vec3d& x) { return std::hypot(x[0] - width / 2, x[1], x[2] - width / 2) <= drop.radius(); },
      [](const Vec3d&) { return Vec3d{}; });
  for (auto& p : start) p.level = drop.level;
  sim::SimulationOptions options;
  options.backend = drop.backend;
  options.method = drop.method;
  options.n_star = static_cast<std::int64_t>(start.size() << drop.level) / 8 + 1;
  scene.fill_max_m = {2 * d * static_cast<double>(options.n_star), 2 * d, 2 * d};
  if (drop.targets) {
    options.forced_targets = *drop.targets;
    auto& region = *options.forced_targets;
    region.centre_m = {width / 2 + region.centre_m[0] * drop.radius(), region.centre_m[1] * drop.radius(),
                       width / 2 + region.centre_m[2] * drop.radius()};
    region.radius_m *= drop.radius();
  }
  if (drop.beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(drop.beta) / (2 * 0.02);  // beta = exp(2 b tau)
  }
  options.start = start;
  return sim::make_simulation(scene, options);
}

/// Mean height over root mean square of the distance from the axis, of the drop and of a cap: neither asks
/// how densely the drop is filled.
double steepness(const State& state) {
  const double x = mean(state, [](const auto& p) { return place(p)[0]; });
  const double z = mean(state, [](const auto& p) { return place(p)[2]; });
  const double square =
      mean(state, [&](const auto& p) { return std::pow(place(p)[0] - x, 2) + std::pow(place(p)[2] - z, 2); });
  return mean(state, [](const auto& p) { return place(p)[1]; }) / std::sqrt(square);
}
double steepness_of_cap(double theta) {
  const double cosine = std::cos(theta);
  double volume = 0, height = 0, square = 0;
  constexpr int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    const double y = (1 - cosine) * (i + 0.5) / steps;
    const double radius2 = 1 - (y + cosine) * (y + cosine);
    volume += radius2;
    height += radius2 * y;
    square += radius2 * radius2 / 2;
  }
  return height / std::sqrt(volume * square);
}
double contact_angle(double steep) {
  double low = 0.05, high = pi - 0.05;
  for (int i = 0; i < 40; ++i) {
    const double theta = (low + high) / 2;
    (steepness_of_cap(theta) < steep ? low : high) = theta;
  }
  return low;
}

/// The drop without what it threw off, which flies for good.
State within_reach(const Drop& drop, State state) {
  std::erase_if(state, [&](const auto& p) {
    const double middle = 3 * drop.radius();
    return std::hypot(place(p)[0] - middle, place(p)[1], place(p)[2] - middle) > 2 * drop.radius();
  });
  return state;
}

/// The work that the angle tells of, over what the scene lists; the angle is the mean of a last half period.
double adhesion_back(const Drop& drop) {
  const auto fluid = start_of(drop);
  const int frames = static_cast<int>(drop.periods * drop.frames());
  double sum = 0;
  int count = 0;
  for (int k = 1; k <= frames; ++k) {
    fluid->step_frame();
    if (k <= frames - drop.frames() / 2 || k % 10) continue;
    sum += contact_angle(steepness(within_reach(drop, fluid->read_state())));
    ++count;
  }
  const double theta = sum / count;
  const auto report = fluid->report();
  std::string levels;
  for (const auto n : report.particles_by_level) levels += " " + std::to_string(n);
  const double solved =
      static_cast<double>(report.temporal.active) / static_cast<double>(fluid->particle_count());
  const State all = fluid->read_state();
  const double thrown = 1 - total_mass(within_reach(drop, all)) / total_mass(all);
  EXPECT_LT(thrown, 0.02);
  const double back = (1 + std::cos(theta)) / drop.share;
  std::printf(
      "adhesion of %.2f sigma, level %d, beta %.2f, %.2f solved, by level%s: %.3f thrown off: "
      "contact angle %.1f degrees, %.3f of what was given\n",
      drop.share, drop.level, drop.beta, solved, levels.c_str(), thrown, theta * 180 / pi, back);
  return back;
}

constexpr double within = 0.15;
/// Of sigma: angles of 120, 90, 78 and 53 degrees.
constexpr double blunt = 0.5, upright = 1, weak = 1.2, strong = 1.6;

void drops_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  for (const double share : {weak, strong}) {
    EXPECT_NEAR(adhesion_back({.share = share, .backend = backend}), 1, within) << share;
    EXPECT_NEAR(adhesion_back({.share = share, .level = 3, .method = MethodKind::LoRes, .backend = backend}),
                1, within)
        << share;
  }
}
void a_drop_that_rests_in_turns(Backend backend) {
  NEEDS_EFFECTS;
  for (const double share : {weak, strong})
    EXPECT_NEAR(adhesion_back({.share = share, .beta = 0.67, .backend = backend}), 1, within) << share;
}
void a_drop_of_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  for (const double share : {weak, strong})
    EXPECT_NEAR(adhesion_back({.share = share,
                               .spacings = 6,
                               .level = 3,
                               .method = MethodKind::Ours,
                               .targets = sim::TargetRegion{{0, 0, 1}, 1, 0, 3},
                               .periods = 3,
                               .backend = backend}),
                1, within)
        << share;
}
void drops_that_the_floor_holds_less(Backend backend) {
  NEEDS_EFFECTS;
  for (const double share : {blunt, upright})
    EXPECT_NEAR(adhesion_back({.share = share, .backend = backend}), 1, 0.3) << share;
}

TEST(TruthAdhesion, DropsOfOneLevelTakeTheirAngle) { drops_of_one_level(Backend::Cpu); }
TEST(TruthAdhesion, ADropThatRestsInTurnsTakesItsAngle) { a_drop_that_rests_in_turns(Backend::Cpu); }
TEST(TruthAdhesion, DropsThatTheFloorHoldsLess) { drops_that_the_floor_holds_less(Backend::Cpu); }
TEST(TruthAdhesionSlow, ADropOfMixedLevelsTakesItsAngle) { a_drop_of_mixed_levels(Backend::Cpu); }
TEST(TruthAdhesionGpu, DropsOfOneLevelTakeTheirAngle) { drops_of_one_level(Backend::Cuda); }
TEST(TruthAdhesionGpu, ADropThatRestsInTurnsTakesItsAngle) { a_drop_that_rests_in_turns(Backend::Cuda); }
TEST(TruthAdhesionGpu, DropsThatTheFloorHoldsLess) { drops_that_the_floor_holds_less(Backend::Cuda); }
TEST(TruthAdhesionGpu, ADropOfMixedLevelsTakesItsAngle) { a_drop_of_mixed_levels(Backend::Cuda); }

}  // namespace
