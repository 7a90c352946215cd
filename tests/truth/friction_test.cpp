/// The effect friction recovered from the distance that plates of thick fluid slide on the floor.

#include "libsim/scene/effects.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;
using sim::EffectKind;

constexpr double d = 0.05;       // spacing of level 0, m
constexpr double height = 0.2;   // height of the plate: four spacings of level 0, two of level 3
constexpr double side = 1.2;     // side of the plate
constexpr double start_x = 1.6;  // the plate's middle, in a tank of 4.8 m
constexpr double speed = 2;
constexpr double given = 1;  // coefficient of friction c of the scene, m/s
constexpr double viscosity = 2;
constexpr int frames = 36;

struct Plate {
  int level = 0;                               ///< level of the particles at the start
  MethodKind method = MethodKind::HiRes;       ///< must allow particles of this level
  std::optional<sim::TargetRegion> targets{};  ///< in metres, relative to the plate's middle
  Backend backend = Backend::Cpu;
};

std::unique_ptr<sim::Simulation> start_of(const Plate& plate) {
  auto scene = fluid_test::tank({4.8, 1.2, 3.2}, {});
  scene.gravity_m_s2 = 2;
  scene.viscosity_m2_s = 0;
  scene.effects = {{EffectKind::Viscosity, viscosity}, {EffectKind::Friction, given}};
  scene.effects[0].options[static_cast<std::size_t>(sim::EffectOption::ViscosityStick)] = 0;
  sim::SimulationOptions options;
  options.backend = plate.backend;
  options.method = plate.method;
  options.substeps = 2;
  State start = lattice(
      d * std::cbrt(1 << plate.level), scene.tank_size_m,
      [&](const Vec3d& x) {
        return x[1] < height && std::abs(x[0] - start_x) < side / 2 && std::abs(x[2] - 1.6) < side / 2;
      },
      [](const Vec3d&) { return Vec3d{}; });
  begin_with(std::move(start), plate.level, d, scene, options);
  if (plate.targets) {
    options.forced_targets = *plate.targets;
    options.forced_targets->centre_m[0] += start_x;
    options.forced_targets->centre_m[2] += 1.6;
  }
  return sim::make_simulation(scene, options);
}

/// Rate at which a plate of this thickness H loses its speed: k^2 nu / H^2 with the lowest root of k tan k =
/// c H / nu.
double rate_of(double c, double thickness) {
  double low = 0, high = pi / 2;
  for (int i = 0; i < 50; ++i) {
    const double k = (low + high) / 2;
    (k * std::tan(k) < c * thickness / viscosity ? low : high) = k;
  }
  return low * low * viscosity / (thickness * thickness);
}

/// Thickness of a rectangular plate: volume over its face on the floor.
double thickness_of(const State& state) {
  double face = 12;
  for (const std::size_t axis : {0u, 2u}) {
    const double middle = mean(state, [&](const auto& p) { return place(p)[axis]; });
    face *= std::sqrt(mean(state, [&](const auto& p) { return std::pow(place(p)[axis] - middle, 2); }));
  }
  return total_mass(state) / mass(ParticleState{}) * d * d * d / face;
}

/// The coefficient c of friction, over that of the scene, from the plate's lost speed v_0 - v and its
/// distance s: the rate of rate_of() is (v_0 - v) / s.
double drag_back(const Plate& plate) {
  const auto fluid = start_of(plate);
  for (int k = 0; k < 20; ++k) fluid->step_frame();  // lets the levels form
  State state = fluid->read_state();
  const double thickness = thickness_of(state);
  state = moving(state, [](const Vec3d&) { return Vec3d{speed, 0, 0}; });
  const double before = mean(state, [](const auto& p) { return place(p)[0]; });
  fluid->put(state);
  for (int k = 0; k < frames; ++k) fluid->step_frame();
  state = fluid->read_state();
  const double way = mean(state, [](const auto& p) { return place(p)[0]; }) - before;
  const double last = mean(state, [](const auto& p) { return velocity(p)[0]; });
  const double rate = (speed - last) / way;
  const double after = thickness_of(state);
  double low = 0, high = 10 * given;
  for (int i = 0; i < 50; ++i) {
    const double c = (low + high) / 2;
    (rate_of(c, (thickness + after) / 2) < rate ? low : high) = c;
  }
  std::string levels;
  for (const auto n : fluid->report().particles_by_level) levels += " " + std::to_string(n);
  std::printf(
      "level %d, by level%s: slid %.3f m, left %.3f m/s, height %.3f to %.3f m: drag %.3f of what was "
      "given\n",
      plate.level, levels.c_str(), way, last, thickness, after, low / given);
  return low / given;
}

constexpr double within = 0.15;
sim::TargetRegion half_fine() { return {{-0.6, 0, -0.9}, 0.9, 0, 3}; }

void plates_of_one_level(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(drag_back({.backend = backend}), 1, within);
  EXPECT_NEAR(drag_back({.level = 3, .method = MethodKind::LoRes, .backend = backend}), 1, within);
}
void a_plate_of_mixed_levels(Backend backend) {
  NEEDS_EFFECTS;
  EXPECT_NEAR(drag_back({.level = 3, .method = MethodKind::Ours, .targets = half_fine(), .backend = backend}),
              1, within);
}

TEST(TruthFriction, PlatesOfOneLevelSlideAsFarAsTheyShould) { plates_of_one_level(Backend::Cpu); }
TEST(TruthFriction, APlateOfMixedLevelsSlidesAsFar) { a_plate_of_mixed_levels(Backend::Cpu); }
TEST(TruthFrictionGpu, PlatesOfOneLevelSlideAsFarAsTheyShould) { plates_of_one_level(Backend::Cuda); }
TEST(TruthFrictionGpu, APlateOfMixedLevelsSlidesAsFar) { a_plate_of_mixed_levels(Backend::Cuda); }

}  // namespace
