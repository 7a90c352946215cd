/// The coefficient c of the effect vorticity recovered from the speed that a Lamb-Oseen vortex gains: it
/// accelerates by c omega(r) round its axis, where omega is the curl at the distance r.

#include "libsim/scene/effects.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/truth/lamb_oseen.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;
using sim::EffectOption;

/// Frames at which the gain is measured: the later, the more of it the method's own viscosity has removed.
constexpr std::array frames{2, 6};
using Gains = std::array<double, frames.size()>;

/// A pool a third as deep as it is wide. Speeds scale with the root of its size, so that pools of all sizes
/// move alike.
struct Pool {
  int spacings = 21;                           ///< across the tank, in the start's level
  int core = 5;                                ///< core radius, in the same spacings
  int level = 0;                               ///< level of the particles at the start
  MethodKind method = MethodKind::HiRes;       ///< must allow particles of this level
  std::optional<sim::TargetRegion> targets{};  ///< in widths, relative to the floor's middle
  Backend backend = Backend::Cpu;

  double finest() const { return 0.05; }
  double spacing() const { return finest() * std::cbrt(1 << level); }
  double width() const { return spacings * spacing(); }
  double radius() const { return core * spacing(); }
  Vortex vortex() const { return {width()}; }
  double scale() const { return std::sqrt(spacing() / finest()); }
  double given() const { return 0.25 * scale(); }
  /// Circulation of a vortex whose largest speed is 1 m/s at level 0.
  double circulation() const { return 10 * scale() * radius(); }
  Vec3d flow(const Vec3d& x) const {
    Vec3d v = vortex().at(x, radius() * radius());
    for (double& one : v) one *= circulation();
    return v;
  }
  /// The pool's water at rest, with its levels.
  State still() const;
  State turning() const {
    return moving(still(), [this](const Vec3d& x) { return flow(x); });
  }
  double omega(double r) const {
    const double c2 = radius() * radius();
    return circulation() / (pi * c2) * std::exp(-r * r / c2);
  }
};

/// Options of the effect, 1/s: it leaves swirl slower than `from` alone, and swirl of `most` and more.
struct Fed {
  double from, most;
};
constexpr Fed everything{0, 1e6};
constexpr Fed usual{sim::usual_options[static_cast<std::size_t>(EffectOption::VorticityFrom)],
                    sim::usual_options[static_cast<std::size_t>(EffectOption::VorticityMost)]};

std::unique_ptr<sim::Simulation> run_of(const Pool& pool, const State& start, double confinement, Fed fed,
                                        double viscosity = 0) {
  auto scene = fluid_test::tank({pool.width(), pool.width(), pool.width()}, {});
  scene.viscosity_m2_s = viscosity;
  scene.effects = {{EffectKind::Vorticity, confinement}};
  scene.effects[0].options[static_cast<std::size_t>(EffectOption::VorticityFrom)] = fed.from;
  scene.effects[0].options[static_cast<std::size_t>(EffectOption::VorticityMost)] = fed.most;
  sim::SimulationOptions options;
  options.backend = pool.backend;
  options.method = pool.method;
  options.substeps = 2;
  options.start = start;
  const double finest_cells = total_mass(start) / mass(ParticleState{});
  options.n_star = static_cast<std::int64_t>(finest_cells / 8) + 1;
  scene.water.front().max_m = {2 * pool.finest() * static_cast<double>(options.n_star), 2 * pool.finest(),
                               2 * pool.finest()};
  if (pool.targets) {
    options.forced_targets = *pool.targets;
    auto& region = *options.forced_targets;
    region.centre_m = {pool.width() * (0.5 + region.centre_m[0]), pool.width() * region.centre_m[1],
                       pool.width() * (0.5 + region.centre_m[2])};
    region.radius_m *= pool.width();
  }
  return sim::make_simulation(scene, options);
}

State Pool::still() const {
  State state = settled(backend, {width(), width() / 3, width()}, spacing(), 40);
  for (auto& p : state) p.level = level;
  if (!targets) return state;
  const auto fluid = run_of(*this, state, 0, everything);
  for (int k = 0; k < 30; ++k) fluid->step_frame();
  return fluid->read_state();
}

/// Speed round the tank's middle over omega(r), by least squares within two cores, m.
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

/// The coefficient of the effect that follows from the gain of speed, over that of the scene, for each of
/// `frames`.
Gains confinement_back(const Pool& pool) {
  const State start = pool.turning();
  Gains gained[2];
  std::string levels;
  for (const bool on : {false, true}) {
    const auto fluid = run_of(pool, start, on ? pool.given() : 0, everything);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      for (int frame = k ? frames[k - 1] : 0; frame < frames[k]; ++frame) fluid->step_frame();
      gained[on][k] = spin(pool, fluid->read_state());
    }
    levels.clear();
    for (const auto n : fluid->report().particles_by_level) levels += " " + std::to_string(n);
  }
  Gains back{};
  for (std::size_t k = 0; k < frames.size(); ++k) {
    back[k] = (gained[1][k] - gained[0][k]) / (frames[k] * sim::Scene{}.frame_dt_s * pool.given());
    std::printf("level %d, by level%s, %d frames: confinement %.3f of what was given\n", pool.level,
                levels.c_str(), frames[k], back[k]);
  }
  return back;
}

constexpr double within = 0.15;
sim::TargetRegion half_fine() { return {{-0.5, 0, 0}, 0.5, 0, 3}; }

void gains(const Pool& pool) {
  for (const double back : confinement_back(pool)) EXPECT_NEAR(back, 1, within);
}

void vortices_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  gains({.backend = backend});
  gains({.level = 3, .method = MethodKind::LoRes, .backend = backend});
}
void a_vortex_of_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  gains({.level = 3, .method = MethodKind::Ours, .targets = half_fine(), .backend = backend});
}

double energy(const State& state) {
  return mean(state, [](const auto& p) {
    const Vec3d v = velocity(p);
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2;
  });
}

/// The core must stay narrower than without the effect, and the energy below that at the start.
void a_core_is_kept_longer(Backend backend) {
  NEEDS_EFFECTS;
  const Pool pool{.backend = backend};
  const State start = pool.turning();
  double core[2], left[2];
  for (const bool on : {false, true}) {
    const auto fluid = run_of(pool, start, on ? 0.1 : 0, usual);
    for (int k = 0; k < 30; ++k) fluid->step_frame();
    const State state = fluid->read_state();
    core[on] = std::sqrt(core_of(state, pool.vortex(), pool.radius()));
    left[on] = energy(state) / energy(start);
  }
  std::printf("core after 0.5 s over that at first: %.3f without, %.3f with; energy: %.3f, %.3f\n",
              core[0] / pool.radius(), core[1] / pool.radius(), left[0], left[1]);
  EXPECT_LT(core[1], 0.9 * core[0]);
  EXPECT_GT(left[1], left[0]);
  EXPECT_LT(left[1], 1);
}

/// With ten times a usual coefficient the energy must stay bounded.
void energy_is_bounded(Backend backend) {
  NEEDS_EFFECTS;
  const Pool pool{.spacings = 15, .core = 4, .backend = backend};
  const State start = pool.turning();
  const auto fluid = run_of(pool, start, 1, usual);
  double most = 0;
  double mean[4] = {};  // of each second
  for (int k = 0; k < 240; ++k) {
    fluid->step_frame();
    if (k % 10 > 0) continue;
    const double now = energy(fluid->read_state()) / energy(start);
    most = std::max(most, now);
    mean[k / 60] += now / 6;
  }
  std::printf("confinement of 1 m/s for 4 s: energy %.2f at most, %.2f and %.2f in the last seconds\n", most,
              mean[2], mean[3]);
  EXPECT_LT(most, 3);
  EXPECT_LT(mean[3], 1.25 * mean[2]);
}

/// rms speed of the water, m/s, after two seconds of the effect with this coefficient; 0: without the effect.
double unrest_of(const Pool& pool, const State& start, double confinement) {
  const auto fluid = run_of(pool, start, confinement, usual, 0.01);
  for (int k = 0; k < 120; ++k) fluid->step_frame();
  return std::sqrt(2 * energy(fluid->read_state()));
}
void still_water_stays_still(Backend backend) {
  NEEDS_EFFECTS;
  for (const int level : {0, 3}) {
    const auto method = level == 0 ? MethodKind::HiRes : MethodKind::LoRes;
    const Pool pool{.spacings = 15, .core = 4, .level = level, .method = method, .backend = backend};
    const State start = pool.still();
    const double without = unrest_of(pool, start, 0), with = unrest_of(pool, start, 0.5);
    std::printf("still water of level %d: %.4f m/s without, %.4f with\n", level, without, with);
    EXPECT_LT(with, std::max(1.1 * without, 0.02)) << "0.02 m/s: still water, where chance decides";
  }
}

TEST(TruthVorticity, VorticesOfOneLevelGainWhatTheyShould) { vortices_of_one_level(Backend::Cpu); }
TEST(TruthVorticity, AVortexOfMixedLevelsGains) { a_vortex_of_mixed_levels(Backend::Cpu); }
TEST(TruthVorticity, ACoreIsKeptLonger) { a_core_is_kept_longer(Backend::Cpu); }
TEST(TruthVorticity, EnergyIsBounded) { energy_is_bounded(Backend::Cpu); }
TEST(TruthVorticity, StillWaterStaysStill) { still_water_stays_still(Backend::Cpu); }
TEST(TruthVorticityGpu, VorticesOfOneLevelGainWhatTheyShould) { vortices_of_one_level(Backend::Cuda); }
TEST(TruthVorticityGpu, AVortexOfMixedLevelsGains) { a_vortex_of_mixed_levels(Backend::Cuda); }
TEST(TruthVorticityGpu, ACoreIsKeptLonger) { a_core_is_kept_longer(Backend::Cuda); }
TEST(TruthVorticityGpu, EnergyIsBounded) { energy_is_bounded(Backend::Cuda); }
TEST(TruthVorticityGpu, StillWaterStaysStill) { still_water_stays_still(Backend::Cuda); }

}  // namespace
