/// Starts from the particles of a checkpoint in the middle of a run: the projections that press them to rest
/// density, and the velocity grid of temporal acceleration, which a checkpoint does not contain.

#include <gtest/gtest.h>

#include "libsim/levels/coarsen.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::Backend;
using sim::MethodKind;

/// A dam that has fallen for half a second: as it is (`finest`), coarsened as far as possible where x < 6 m
/// (`mixed`), and coarsened everywhere (`coarsest`).
struct Fallen {
  sim::Scene scene = sim::read_scene("data/scenes/single_dam.toml");
  sim::SimulationOptions options;
  std::vector<ParticleState> finest, mixed, coarsest;

  explicit Fallen(Backend backend) {
    options.backend = backend;
    options.n_star = 256;
    scene.settle_frames = 30;
    const auto dam = sim::make_simulation(scene, options);
    for (int frame = 0; frame < 30; ++frame) dam->step_frame();
    finest = dam->read_state();
    std::vector<std::uint8_t> wishes;
    for (const auto& p : finest) wishes.push_back(p.x_m < 6 ? 3 : 0);
    mixed = sim::coarsen(finest, wishes);
    coarsest = sim::coarsen(finest, std::vector<std::uint8_t>(finest.size(), 3));
    options.start_frame = 30;
  }

  std::unique_ptr<sim::Simulation> start(MethodKind method, const std::vector<ParticleState>& state,
                                         int projections) const {
    auto chosen = options;
    chosen.method = method;
    chosen.start = state;
    chosen.start_projections = projections;
    return sim::make_simulation(scene, chosen);
  }
};

/// Mass-weighted mean of max(rho / rho_0 - 1, 0).
double compression_of_mass(sim::Simulation& fluid) {
  // measure_saliency computes the density at the particles' positions and leaves it in the column.
  const sim::View view = sim::make_view({}, 64, 48);
  std::vector<sim::ParticleSaliency> unused;
  const sim::EyeLook eye{{{0, 1, 3}, {0, 0, -1}, true}, view, nullptr};
  fluid.measure_saliency({{eye}}, unused);
  std::vector<float> error;
  std::vector<sim::RenderParticle> particles;
  fluid.read_field(sim::ParticleField::DensityError, error);
  fluid.read_particles(particles);
  double sum = 0;
  double mass = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double own = std::pow(static_cast<double>(particles[i].radius_m), 3);
    sum += own * static_cast<double>(std::max(error[i], 0.0F));
    mass += own;
  }
  return sum / mass;
}

void projections_press_a_start_below_one_percent(Backend backend) {
  const Fallen dam(backend);
  for (const auto& [method, state] : {std::pair{MethodKind::LoRes, dam.coarsest},
                                      {MethodKind::Ours, dam.mixed},
                                      {MethodKind::HiRes, dam.finest}}) {
    const std::string who = sim::method_name(method);
    const auto plain = dam.start(method, state, 0);
    const double before = compression_of_mass(*plain);
    EXPECT_EQ(before > 0.01, method != MethodKind::HiRes) << who << ": something to do";
    const auto fluid = dam.start(method, state, 50);
    EXPECT_LT(compression_of_mass(*fluid), 0.01) << who;
    EXPECT_NEAR(fluid->report().start.compression, compression_of_mass(*fluid), 1e-5) << who;
    EXPECT_EQ(fluid->report().start.projections > 0, before > 0.01) << who;
    EXPECT_EQ(fluid->report().guards.wall_projected, 0u) << who << ": counts begin with the run";
    EXPECT_EQ(fluid->report().frame, 30) << who;
    const auto after = fluid->read_state();
    ASSERT_EQ(after.size(), state.size()) << who;
    double most = 0;
    double mean = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const auto& a = state[i];
      const auto& b = after[i];
      ASSERT_EQ(a.id, b.id) << who;
      ASSERT_EQ(a.level, b.level) << who;
      ASSERT_TRUE(a.vx_m_s == b.vx_m_s && a.vy_m_s == b.vy_m_s && a.vz_m_s == b.vz_m_s) << who;
      const double way = std::hypot(static_cast<double>(a.x_m - b.x_m), static_cast<double>(a.y_m - b.y_m),
                                    static_cast<double>(a.z_m - b.z_m)) /
                         (fluid->spacing_m() * std::cbrt(1 << a.level));
      most = std::max(most, way);
      mean += way / static_cast<double>(after.size());
    }
    EXPECT_LT(most, 1) << who << ", spacings";
    EXPECT_LT(mean, 0.15) << who << ", spacings";
    EXPECT_EQ(mean > 0, method != MethodKind::HiRes) << who;
    EXPECT_EQ(fluid_test::outside(after, dam.scene.tank_size_m, 0), 0) << who;
  }
}
TEST(Start, ProjectionsPressItBelowOnePercent) { projections_press_a_start_below_one_percent(Backend::Cpu); }
TEST(StartGpu, ProjectionsPressItBelowOnePercent) {
  projections_press_a_start_below_one_percent(Backend::Cuda);
}

TEST(Start, NoMoreProjectionsThanAllowed) {
  const Fallen dam(Backend::Cpu);
  auto squeezed = dam.coarsest;
  for (auto& p : squeezed) p.y_m *= 0.8F;
  const auto error = [&](int most) {
    return dam.start(MethodKind::LoRes, squeezed, most)->report().density_error_mean;
  };
  EXPECT_GT(error(0), 0.05);
  EXPECT_LT(error(1), error(0));
  EXPECT_LT(error(4), error(1));
}

void the_velocity_grid_comes_with_the_start(Backend backend) {
  const Fallen dam(backend);
  auto chosen = dam.options;
  chosen.temporal.fixed_tau = -20;
  chosen.temporal.always = true;
  chosen.start = dam.finest;
  const auto active_share = [&](int projections) {
    chosen.start_projections = projections;
    const auto fluid = sim::make_simulation(dam.scene, chosen);
    fluid->step_frame();
    return static_cast<double>(fluid->report().temporal.active) / static_cast<double>(dam.finest.size());
  };
  // Without projections there is no velocity grid yet; then all particles have the same importance, and all
  // are solved.
  EXPECT_EQ(active_share(0), 1);
  EXPECT_LT(active_share(50), 0.97);
}
TEST(Start, TheVelocityGridComesWithIt) { the_velocity_grid_comes_with_the_start(Backend::Cpu); }
TEST(StartGpu, TheVelocityGridComesWithIt) { the_velocity_grid_comes_with_the_start(Backend::Cuda); }

void ids_and_gaze_targets_follow_the_order_of_the_particles(Backend backend) {
  const Fallen dam(backend);
  const auto fluid = dam.start(MethodKind::HiRes, dam.finest, 0);
  fluid->step_frame();  // shuffles the columns
  const auto state = fluid->read_state();
  const auto check_order = [&] {
    std::vector<sim::RenderParticle> drawn;
    fluid->read_particles(drawn);
    const auto ids = fluid->read_ids();
    ASSERT_EQ(ids.size(), drawn.size());
    for (std::size_t i = 0; i < ids.size(); ++i)
      ASSERT_EQ(state[static_cast<std::size_t>(ids[i])].x_m, drawn[i].x_m);
  };
  check_order();
  sim::EyeLook eye;
  eye.view = sim::make_view(dam.scene.view, 160, 90);
  eye.gaze = {dam.scene.view.eye_m, {-3.2, -0.2, -2.5}, true};
  std::vector<sim::ParticleSaliency> by_gaze;
  fluid->measure_gaze_targets({{eye}}, by_gaze);
  check_order();
  // FovFluid finds the targets that measure_gaze_targets() found, at the start of its first frame, before
  // anything has moved.
  const auto follower = dam.start(MethodKind::FovFluid, state, 0);
  follower->look({{eye}});
  std::map<int, std::pair<float, int>> expected;
  const auto ids = fluid->read_ids();
  for (std::size_t i = 0; i < ids.size(); ++i) expected[ids[i]] = {by_gaze[i].s, by_gaze[i].target};
  follower->step_frame();
  std::vector<sim::ParticleSaliency> own;
  follower->read_saliency(own);
  const auto own_ids = follower->read_ids();
  int fovea = 0, periphery = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    ASSERT_EQ(own[i].s, expected.at(own_ids[i]).first);
    fovea += expected.at(own_ids[i]).second == 0;
    periphery += expected.at(own_ids[i]).second == 3;
  }
  EXPECT_GT(fovea, 20);
  EXPECT_GT(periphery, 200);
}
TEST(Start, IdsAndGazeTargetsFollowTheOrderOfTheParticles) {
  ids_and_gaze_targets_follow_the_order_of_the_particles(Backend::Cpu);
}
TEST(StartGpu, IdsAndGazeTargetsFollowTheOrderOfTheParticles) {
  ids_and_gaze_targets_follow_the_order_of_the_particles(Backend::Cuda);
}

}  // namespace
