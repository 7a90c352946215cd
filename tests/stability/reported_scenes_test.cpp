/// Scenes that users of other solvers reported as failing, in tests/stability/reported: each must meet its
/// criterion under all five methods.

#include <gmock/gmock.h>

#include "libsim/cases/water.hpp"
#include "stats/base/error.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/levels_helpers.hpp"
#include "tests/libsim/obstacle_scenes.hpp"

namespace {

using namespace levels_test;
using sim::MethodKind;
using sim::Vec3d;

constexpr MethodKind five[] = {MethodKind::LoRes, MethodKind::HiRes, MethodKind::FovFluid, MethodKind::Ours,
                               MethodKind::OursTsp};

bool has_levels(MethodKind method) { return method != MethodKind::LoRes && method != MethodKind::HiRes; }

sim::Scene reported(const std::string& name) {
  return sim::read_scene(std::string(VIP_TEST_DIR) + "/stability/reported/" + name + ".toml");
}

/// A run whose viewer looks at one point.
class Watched {
 public:
  Watched(sim::Scene scene, Backend backend, MethodKind method, const Vec3d& gaze_m,
          std::int64_t n_star = 512)
      : scene_(std::move(scene)), gaze_m_(gaze_m) {
    sim::SimulationOptions options;
    options.method = method;
    options.n_star = n_star;
    options.backend = backend;
    options.temporal.fixed_tau = -6;
    fluid_ = sim::make_simulation(scene_, options);
  }
  /// The state at this time; call it with increasing times.
  std::vector<ParticleState> at(double time_s) {
    while (fluid_->time_s() < time_s - scene_.frame_dt_s / 2) {
      fluid_->look(sim::cases::look_at(scene_, gaze_m_));
      fluid_->step_frame();
    }
    EXPECT_FALSE(fluid_->divergence());
    EXPECT_EQ(fluid_->report().guards.not_finite, 0u);
    return fluid_->read_state();
  }
  sim::Simulation& fluid() { return *fluid_; }

 private:
  sim::Scene scene_;
  Vec3d gaze_m_;
  std::unique_ptr<sim::Simulation> fluid_;
};

/// The pool must be slower than S1's limit, 0.02 sqrt(g H).
void pool_rests(const sim::Scene& scene, Backend backend, MethodKind method, double seconds) {
  Watched run(scene, backend, method, {0.6, 0.9, 0.9});
  double rms = 0;
  constexpr int readings = 10;
  for (int k = 1; k <= readings; ++k) rms += sim::cases::rms_speed(run.at(seconds - 1 + 0.1 * k)) / readings;
  std::printf("%s, %d bodies: v_rms %.4f m/s\n", sim::method_name(method).c_str(),
              static_cast<int>(scene.obstacles.size()), rms);
  EXPECT_LT(rms, 0.063);
}

/// The pool with a ball and two boxes that float.
sim::Scene pool_with_bodies() {
  auto out = reported("pool_only");
  out.obstacles = {obstacle_test::sphere({0.35, 1.05, 0.35}, 0.15),
                   obstacle_test::box({0.8, 1.05, 0.4}, {0.25, 0.2, 0.3}),
                   obstacle_test::box({0.6, 1.05, 0.85}, {0.4, 0.15, 0.25})};
  for (auto& body : out.obstacles) {
    body.motion = sim::ObstacleMotion::Free;
    body.density_kg_m3 = 500;
  }
  return out;
}

/// Fluid of 1000 m2/s and height H slumps at about g H^2 / (3 nu) = 1 mm/s in theory.
void thick_column_slumps_slowly(Backend backend, MethodKind method) {
  NEEDS_EFFECTS;
  Watched run(reported("visc"), backend, method, {0.3, 0.3, 0.5});
  const double before = sim::cases::centre_height(run.at(0.5));
  const double speed = before - sim::cases::centre_height(run.at(1.5));
  std::printf("%s: the centre of mass sinks by %.2f mm/s\n", sim::method_name(method).c_str(), 1000 * speed);
  EXPECT_LT(speed, 0.001);
}

/// Uniform warmth moves nothing: the centre of mass goes where that of cold water goes.
void warm_water_rests(Backend backend, MethodKind method, double seconds) {
  NEEDS_EFFECTS;
  double height[2];
  for (const bool warm : {false, true}) {
    auto scene = reported("warm");
    if (!warm) scene.warm.clear();
    Watched run(scene, backend, method, {0.5, 0.5, 0.5});
    height[warm] = sim::cases::centre_height(run.at(seconds));
  }
  std::printf("%s: centre of mass at %.4f m, cold at %.4f m\n", sim::method_name(method).c_str(), height[1],
              height[0]);
  EXPECT_NEAR(height[1], height[0], 0.01 * height[0]);
}

/// Volume of the box that leaves out half a percent of the mass at either end of each axis, m3.
double volume(const std::vector<ParticleState>& state) {
  constexpr double left_out = 0.005;
  double out = 1;
  for (const auto axis : {&ParticleState::x_m, &ParticleState::y_m, &ParticleState::z_m}) {
    std::vector<float> places;  // one for each unit of mass: a particle counts 2^level times
    for (const auto& p : state) places.insert(places.end(), std::size_t{1} << p.level, p.*axis);
    std::sort(places.begin(), places.end());
    const auto skipped = static_cast<std::size_t>(left_out * static_cast<double>(places.size()));
    out *= static_cast<double>(places[places.size() - 1 - skipped] - places[skipped]);
  }
  return out;
}

void weightless_water_keeps_its_volume(Backend backend, MethodKind method, double seconds,
                                       std::int64_t n_star = 512) {
  Watched run(reported("zerog"), backend, method, {0.6, 0.6, 0.6}, n_star);
  const double before = volume(run.at(0));
  const double share = volume(run.at(seconds)) / before;
  const auto events = run.fluid().report().levels;
  std::printf("%s, n_* = %lld: %.3f of its volume after %.0f s, %llu splits, %llu merges\n",
              sim::method_name(method).c_str(), static_cast<long long>(n_star), share, seconds,
              static_cast<unsigned long long>(events.splits), static_cast<unsigned long long>(events.merges));
  EXPECT_GE(events.merges, has_levels(method) ? 100u : 0u);
  EXPECT_LT(share, 1.15);
}

void closed_press_is_refused(Backend backend, MethodKind method) {
  try {
    Watched(reported("press"), backend, method, {0.5, 0.5, 0.5});
    FAIL() << "0.8 m3 of water have room for 0.55 m3";
  } catch (const base::Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("obstacle 1 (box)"));
    EXPECT_THAT(e.what(), testing::HasSubstr("mend: "));
  }
}

void all_of(void (*scene)(Backend, MethodKind), Backend backend) {
  for (const MethodKind method : five) {
    SCOPED_TRACE(sim::method_name(method));
    scene(backend, method);
  }
}
void pool(Backend backend, MethodKind method) {
  pool_rests(reported("pool_only"), backend, method, 10);
  pool_rests(pool_with_bodies(), backend, method, 10);
}
void warm(Backend backend, MethodKind method) { warm_water_rests(backend, method, 2); }
void weightless(Backend backend, MethodKind method) {
  for (const std::int64_t n_star : {512, 2048})
    weightless_water_keeps_its_volume(backend, method, 10, n_star);
}

TEST(ReportedScenes, WarmWaterRests) { warm_water_rests(Backend::Cpu, MethodKind::LoRes, 0.5); }
TEST(ReportedScenes, WeightlessWaterKeepsItsVolume) {
  weightless_water_keeps_its_volume(Backend::Cpu, MethodKind::Ours, 1);
}
TEST(ReportedScenes, AClosedPressIsRefused) { all_of(closed_press_is_refused, Backend::Cpu); }
TEST(ReportedScenesSlow, APoolRests) { all_of(pool, Backend::Cpu); }
TEST(ReportedScenesSlow, AThickColumnSlumpsSlowly) { all_of(thick_column_slumps_slowly, Backend::Cpu); }
TEST(ReportedScenesSlow, WarmWaterRests) { all_of(warm, Backend::Cpu); }
TEST(ReportedScenesSlow, WeightlessWaterKeepsItsVolume) { all_of(weightless, Backend::Cpu); }
TEST(ReportedScenesGpu, APoolRests) { all_of(pool, Backend::Cuda); }
TEST(ReportedScenesGpu, AThickColumnSlumpsSlowly) { all_of(thick_column_slumps_slowly, Backend::Cuda); }
TEST(ReportedScenesGpu, WarmWaterRests) { all_of(warm, Backend::Cuda); }
TEST(ReportedScenesGpu, WeightlessWaterKeepsItsVolume) { all_of(weightless, Backend::Cuda); }
TEST(ReportedScenesGpu, AClosedPressIsRefused) { all_of(closed_press_is_refused, Backend::Cuda); }

}  // namespace
