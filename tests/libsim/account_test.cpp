/// Each frame's account (Simulation::account) against values computed from the particles.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;
using sim::MethodKind;

sim::SimulationOptions options_of(Backend backend, MethodKind method) {
  sim::SimulationOptions options;
  options.backend = backend;
  options.method = method;
  options.n_star = 256;
  return options;
}

/// Particles of each level that the method may use, counted one by one.
std::vector<std::int64_t> counted(const sim::Simulation& fluid) {
  std::vector<sim::RenderParticle> particles;
  fluid.read_particles(particles);
  std::vector<std::int64_t> out;
  for (const float radius : fluid.radii_m()) {
    out.push_back(std::count_if(particles.begin(), particles.end(),
                                [&](const auto& particle) { return particle.radius_m == radius; }));
  }
  return out;
}

std::int64_t counted_active(const sim::Simulation& fluid) {
  std::vector<float> active;
  fluid.read_field(sim::ParticleField::Active, active);
  return std::count(active.begin(), active.end(), 1.0f);
}

void counts_what_is_there(Backend backend) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  auto options = options_of(backend, MethodKind::OursTsp);
  options.temporal.fixed_rate = sim::FrameRate{16, 4};
  const auto fluid = sim::make_simulation(scene, options);
  EXPECT_EQ(fluid->account().particles_by_level, counted(*fluid)) << "before the first frame";
  EXPECT_FALSE(fluid->account().temporal || fluid->account().guards);
  bool several = false, left_out = false;
  for (int frame = 1; frame <= 60; ++frame) {
    SCOPED_TRACE(frame);
    fluid->step_frame();
    const sim::FrameAccount account = fluid->account();
    ASSERT_EQ(account.particles_by_level, counted(*fluid));
    ASSERT_TRUE(account.temporal);
    ASSERT_EQ(account.temporal->active, counted_active(*fluid));
    EXPECT_EQ(account.temporal->rate, (sim::FrameRate{16, 4}));
    EXPECT_NEAR(account.temporal->tau.value(), 16 - 23.68 * std::exp(0.08), 1e-12);
    EXPECT_NEAR(account.temporal->beta, std::exp(0.04 * *account.temporal->tau), 1e-12);
    several = several || account.particles() - account.particles_by_level.back() > account.particles() / 10;
    left_out = left_out || account.temporal->active < account.particles() * 95 / 100;
  }
  EXPECT_TRUE(several && left_out) << "otherwise there was nothing to count";
}
TEST(Account, CountsWhatIsThere) { counts_what_is_there(Backend::Cpu); }
TEST(AccountGpu, CountsWhatIsThere) { counts_what_is_there(Backend::Cuda); }

/// Counts of guards in the accounts of all frames so far must add up to those in the run's report.
void guards_are_of_one_frame(Backend backend) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  const auto fluid = sim::make_simulation(scene, options_of(backend, MethodKind::Ours));
  std::uint64_t walls = 0, lost = 0;
  for (int frame = 0; frame < 40; ++frame) {
    if (frame % 4 == 3) fluid->look({{{sim::Gaze{}, sim::make_view(scene.view, 64, 36), nullptr}}});
    fluid->step_frame();
    const auto guards = fluid->account().guards.value();
    walls += guards.wall_projected;
    lost += guards.gaze_lost;
    const auto all = fluid->report().guards;
    EXPECT_EQ(walls, all.wall_projected);
    EXPECT_EQ(lost, all.gaze_lost);
  }
  EXPECT_GT(walls, 0u);
  EXPECT_GT(lost, 0u);
  EXPECT_LE(fluid->account().guards->gaze_lost, 1u) << "one eye";
}
TEST(Account, GuardsAreOfOneFrame) { guards_are_of_one_frame(Backend::Cpu); }
TEST(AccountGpu, GuardsAreOfOneFrame) { guards_are_of_one_frame(Backend::Cuda); }

void methods_without_tau_have_none(Backend backend) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  for (const MethodKind method :
       {MethodKind::LoRes, MethodKind::HiRes, MethodKind::FovFluid, MethodKind::Ours}) {
    const auto fluid = sim::make_simulation(scene, options_of(backend, method));
    fluid->step_frame();
    EXPECT_FALSE(fluid->account().temporal) << sim::method_name(method);
    EXPECT_TRUE(fluid->account().guards);
    EXPECT_EQ(fluid->account().particles(), fluid->particle_count());
    EXPECT_EQ(fluid->account().particles_by_level.size(), fluid->radii_m().size());
  }
}
TEST(Account, MethodsWithoutTauHaveNone) { methods_without_tau_have_none(Backend::Cpu); }
TEST(AccountGpu, MethodsWithoutTauHaveNone) { methods_without_tau_have_none(Backend::Cuda); }

/// Tau, which decides how many particles may rest, follows from the durations of frames. A frame is solved
/// before its own duration is known, so its account must give the tau from the durations of earlier frames.
TEST(Account, TauIsWhatTheFrameWentByNotWhatCameAfterIt) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  const auto fluid = sim::make_simulation(scene, options_of(Backend::Cpu, MethodKind::OursTsp));
  fluid->step_frame();
  EXPECT_FALSE(fluid->account().temporal->tau) << "no frame's time was known";
  EXPECT_EQ(fluid->account().temporal->beta, 1);
  fluid->frame_time(100);
  EXPECT_FALSE(fluid->account().temporal->tau);
  fluid->step_frame();
  EXPECT_NEAR(fluid->account().temporal->tau.value(), 10 - 23.68, 1e-9);
  EXPECT_NEAR(fluid->account().temporal->rate->mean, 10, 1e-9);
  EXPECT_EQ(fluid->account().temporal->active, fluid->particle_count()) << "too few frames to switch on";
}

/// From the same start, both back ends report for the first frames the same tau, frame rate, beta and lost
/// gazes. The numbers of active particles and of particles by level may differ by 2 %, where rounding decides
/// at a threshold.
TEST(AccountGpu, AgreesWithTheCpus) {
  const auto scene = sim::read_scene("data/scenes/single_dam.toml");
  auto options = options_of(Backend::Cpu, MethodKind::OursTsp);
  options.start = sim::make_simulation(scene, options)->read_state();
  options.temporal.fixed_rate = sim::FrameRate{16, 4};
  const auto cpu = sim::make_simulation(scene, options);
  options.backend = Backend::Cuda;
  const auto cuda = sim::make_simulation(scene, options);
  EXPECT_EQ(cpu->account().particles_by_level, cuda->account().particles_by_level);
  for (int frame = 1; frame <= 3; ++frame) {
    SCOPED_TRACE(frame);
    cpu->step_frame();
    cuda->step_frame();
    const sim::FrameAccount a = cpu->account(), b = cuda->account();
    EXPECT_EQ(a.temporal->tau, b.temporal->tau);
    EXPECT_EQ(a.temporal->rate, b.temporal->rate);
    EXPECT_EQ(a.temporal->beta, b.temporal->beta);
    const auto near = static_cast<double>(a.particles()) / 50;
    EXPECT_NEAR(static_cast<double>(a.temporal->active), static_cast<double>(b.temporal->active), near);
    ASSERT_EQ(a.particles_by_level.size(), b.particles_by_level.size());
    for (std::size_t k = 0; k < a.particles_by_level.size(); ++k) {
      EXPECT_NEAR(static_cast<double>(a.particles_by_level[k]), static_cast<double>(b.particles_by_level[k]),
                  near);
    }
    EXPECT_EQ(a.guards->not_finite, b.guards->not_finite);
    EXPECT_EQ(a.guards->gaze_lost, b.guards->gaze_lost);
  }
}

TEST(Account, ATauAndItsFrameRateAreNotBothGiven) {
  EXPECT_THROW(sim::ToleranceSwitch({}, -6.0, sim::FrameRate{16, 4}), base::Error);
  EXPECT_EQ(sim::parse_frame_rate("16.5,4"), (sim::FrameRate{16.5, 4}));
  for (const char* bad : {"", "16", "16,", ",4", "16,4,2", "16,-1", "0,1", "nan,1", "16,inf", "16, 4"})
    EXPECT_THROW(sim::parse_frame_rate(bad), base::Error) << bad;
}

}  // namespace
