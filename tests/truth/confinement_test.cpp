/// The effect vorticity measured back from what it adds to a Lamb-Oseen vortex: c omega(r) round its axis.

#include "libsim/scene/effects.hpp"
#include "tests/truth/lamb_oseen.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;
using sim::EffectOption;

#define NEEDS_EFFECTS \
  if (!sim::has_effects()) GTEST_SKIP() << "built with -DVIP_EFFECTS=OFF"

constexpr int spacings = 24;  // of the start's level, across the tank
constexpr int core = 5;       // in the same

/// A pool eight spacings deep. Speeds go as the root of its size, so that pools of all sizes move alike.
struct Pool {
  int level = 0;                               ///< of the start
  MethodKind method = MethodKind::HiRes;       ///< that holds this level
  std::optional<sim::TargetRegion> targets{};  ///< in widths, from the floor's middle
  double beta = 1;
  Backend backend = Backend::Cpu;

  double finest() const { return 0.05; }
  double spacing() const { return finest() * std::cbrt(1 << level); }
  double width() const { return spacings * spacing(); }
  double radius() const { return core * spacing(); }
  Vortex vortex() const { return {width()}; }
  double scale() const { return std::sqrt(spacing() / finest()); }
  double given() const { return 0.25 * scale(); }
  int frames() const { return static_cast<int>(std::lround(2 * scale())); }
  /// Of a vortex whose largest speed is 1 m/s at level 0.
  double circulation() const { return 10 * scale() * radius(); }
  Vec3d flow(const Vec3d& x) const {
    Vec3d v = vortex().at(x, radius() * radius());
    for (double& one : v) one *= circulation();
    return v;
  }
  double omega(double r) const {
    const double c2 = radius() * radius();
    return circulation() / (pi * c2) * std::exp(-r * r / c2);
  }
};

std::unique_ptr<sim::Simulation> run_of(const Pool& pool, const State& start, double confinement,
                                        double from = 0, double most = 1e6) {
  auto scene = fluid_test::tank({pool.width(), pool.width(), pool.width()}, {});
  scene.viscosity_m2_s = 0;
  scene.effects = {{EffectKind::Vorticity, confinement}};
  scene.effects[0].options[static_cast<std::size_t>(EffectOption::VorticityFrom)] = from;
  scene.effects[0].options[static_cast<std::size_t>(EffectOption::VorticityMost)] = most;
  sim::SimulationOptions options;
  options.backend = pool.backend;
  options.method = pool.method;
  options.substeps = 2;
  options.start = start;
  const double finest_cells = total_mass(start) / mass(ParticleState{});
  options.n_star = static_cast<std::int64_t>(finest_cells / 8) + 1;
  scene.fill_max_m = {2 * pool.finest() * static_cast<double>(options.n_star), 2 * pool.finest(),
                      2 * pool.finest()};
  if (pool.targets) {
    options.forced_targets = *pool.targets;
    auto& region = *options.forced_targets;
    region.centre_m = {pool.width() * (0.5 + region.centre_m[0]), pool.width() * region.centre_m[1],
                       pool.width() * (0.5 + region.centre_m[2])};
    region.radius_m *= pool.width();
  }
  if (pool.beta < 1) {
    options.temporal.always = true;
    options.temporal.fixed_tau = std::log(pool.beta) / (2 * 0.02);  // beta = exp(2 b tau)
  }
  return sim::make_simulation(scene, options);
}

/// At rest, with its levels.
State still(const Pool& pool) {
  State state = settled(pool.backend, {pool.width(), pool.width() / 3, pool.width()}, pool.spacing(), 40);
  for (auto& p : state) p.level = pool.level;
  if (!pool.targets) return state;
  const auto fluid = run_of(pool, state, 0);
  for (int k = 0; k < 30; ++k) fluid->step_frame();
  return fluid->read_state();
}

/// Speed round the tank's middle over omega(r), by least squares within two cores, s.
double spin(const Pool& pool, const State& state) {
  double along = 0, norm = 0;
  for (const auto& p : state) {
    const double x = place(p)[0] - pool.width() / 2, z = place(p)[2] - pool.width() / 2;
    const double r = std::hypot(x, z);
    if (r > 2 * pool.radius() || r == 0) continue;
    const double omega = pool.omega(r);
    along += mass(p) * omega * (velocity(p)[0] * z - velocity(p)[2] * x) / r;
    norm += mass(p) * omega * omega;
  }
  return along / norm;
}

double confinement_back(const Pool& pool) {
  const State start = moving(still(pool), [&](const Vec3d& x) { return pool.flow(x); });
  double gained[2];
  std::string levels;
  double time = 0, solved = 1;
  for (const bool on : {false, true}) {
    const auto fluid = run_of(pool, start, on ? pool.given() : 0);
    // Who rests is chosen by what the last frames were like.
    for (int k = 0; k < (pool.beta < 1 ? 30 : 0); ++k) fluid->step_frame();
    fluid->put(start);
    for (int k = 0; k < pool.frames(); ++k) fluid->step_frame();
    gained[on] = spin(pool, fluid->read_state());
    time = pool.frames() * sim::Scene{}.frame_dt_s;
    levels.clear();
    const auto report = fluid->report();
    for (const auto n : report.particles_by_level) levels += " " + std::to_string(n);
    solved = static_cast<double>(report.temporal.active) / static_cast<double>(fluid->particle_count());
  }
  const double back = (gained[1] - gained[0]) / (time * pool.given());
  std::printf("level %d, beta %.2f, %.2f solved, by level%s: confinement %.3f of what was given\n",
              pool.level, pool.beta, solved, levels.c_str(), back);
  return back;
}

constexpr double within = 0.15;
sim::TargetRegion half_fine() { return {{-0.5, 0, 0}, 0.5, 0, 3}; }

void vortices_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(confinement_back({.backend = backend}), 1, within);
  EXPECT_NEAR(confinement_back({.level = 3, .method = MethodKind::LoRes, .backend = backend}), 1, within);
}
void a_vortex_of_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(
      confinement_back({.level = 3, .method = MethodKind::Ours, .targets = half_fine(), .backend = backend}),
      1, within);
}
void a_vortex_that_rests_in_turns(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(confinement_back({.beta = 0.67, .backend = backend}), 1, within);
}

double energy(const State& state) {
  return mean(state, [](const auto& p) {
    const Vec3d v = velocity(p);
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2;
  });
}

/// The core stays narrower than without, and the water's energy below what it began with.
void a_core_is_kept_longer(Backend backend) {
  NEEDS_EFFECTS;
  const Pool pool{.backend = backend};
  const State start = moving(still(pool), [&](const Vec3d& x) { return pool.flow(x); });
  for (const double c : {0.0, 0.02, 0.05, 0.1, 0.2}) {
    const auto fluid = run_of(pool, start, c, 2, 50);
    for (int k = 1; k <= 60; ++k) {
      fluid->step_frame();
      if (k % 15 == 0) {
        const State state = fluid->read_state();
        std::printf("c %.2f frame %d: core %.3f, energy %.3f\n", c, k,
                    std::sqrt(core_of(state, pool.vortex(), pool.radius())), energy(state) / energy(start));
      }
    }
  }
}
void still_water(Backend backend) {
  NEEDS_EFFECTS;
  for (const int level : {0, 3}) {
    const Pool pool{
        .level = level, .method = level ? MethodKind::LoRes : MethodKind::HiRes, .backend = backend};
    const State start = still(pool);
    for (const double c : {0.0, 0.1, 0.5}) {
      const auto fluid = run_of(pool, start, c, 2, 50);
      for (int k = 1; k <= 120; ++k) fluid->step_frame();
      std::printf("level %d c %.2f: still %.4f -> %.4f\n", level, c, std::sqrt(2 * energy(start)),
                  std::sqrt(2 * energy(fluid->read_state())));
    }
  }
}

TEST(TruthVorticity, VorticesOfOneLevelGainWhatTheyShould) { vortices_of_one_level(Backend::Cpu); }
TEST(TruthVorticity, AVortexOfMixedLevelsGains) { a_vortex_of_mixed_levels(Backend::Cpu); }
TEST(TruthVorticity, AVortexThatRestsInTurnsGains) { a_vortex_that_rests_in_turns(Backend::Cpu); }
TEST(TruthVorticity, ACoreIsKeptLonger) { a_core_is_kept_longer(Backend::Cpu); }
TEST(TruthVorticity, Still) { still_water(Backend::Cpu); }

}  // namespace
