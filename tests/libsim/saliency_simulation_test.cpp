/// Saliency inside a simulation: the methods that run it, and its results.

#include <gtest/gtest.h>
#include <omp.h>

#include <limits>

#include "stats/base/error.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;
using sim::MethodKind;

/// A block of 2,048 fine particles that falls apart, seen from the front.
sim::Scene scene() {
  auto out = fluid_test::tank({4.8, 4, 2.4}, {2.4, 2.4, 1.2});
  out.view.eye_m = {2.4, 1.6, 5.2};
  out.view.target_m = {2.4, 1, 1.2};
  return out;
}

std::unique_ptr<sim::Simulation> make(Backend backend, MethodKind method, bool parts = false) {
  sim::SimulationOptions options;
  options.method = method;
  options.backend = backend;
  options.n_star = 256;
  options.saliency_parts = parts;
  return sim::make_simulation(scene(), options);
}

sim::EyeLook eye_at(sim::Vec3d gaze) {
  const auto view = sim::make_view(scene().view, 320, 240);
  return {{scene().view.eye_m, gaze, true}, view, nullptr};
}
const sim::Vec3d ahead{0, -0.6, -4};

void only_methods_that_follow_a_gaze_pay_for_it(Backend backend) {
  for (const MethodKind method : {MethodKind::LoRes, MethodKind::HiRes}) {
    const auto fluid = make(backend, method, true);
    fluid->step_frame();
    const auto bytes = fluid->particle_bytes();
    fluid->look({{eye_at(ahead)}});
    fluid->step_frame();
    std::vector<sim::ParticleSaliency> saliency(3);
    fluid->read_saliency(saliency);
    EXPECT_TRUE(saliency.empty());
    EXPECT_EQ(fluid->particle_bytes(), bytes);
    EXPECT_NE(fluid->explain().find("-  saliency"), std::string::npos);
    EXPECT_NE(fluid->explain().find("-  gaze targets"), std::string::npos);
    EXPECT_EQ(fluid->report().guards.gaze_lost, 0u);
  }
  const auto ours = make(backend, MethodKind::Ours);
  EXPECT_NE(ours->explain().find("frame start  saliency"), std::string::npos);
  EXPECT_NE(ours->explain().find("-  saliency parts"), std::string::npos);
  EXPECT_THROW(ours->look({}), base::Error);
}
TEST(SaliencyInSimulations, OnlyMethodsThatFollowAGazePayForIt) {
  only_methods_that_follow_a_gaze_pay_for_it(Backend::Cpu);
}
TEST(SaliencyInSimulationsGpu, OnlyMethodsThatFollowAGazePayForIt) {
  only_methods_that_follow_a_gaze_pay_for_it(Backend::Cuda);
}

void parts_make_up_the_whole(Backend backend) {
  const auto fluid = make(backend, MethodKind::Ours, true);
  std::vector<sim::ParticleSaliency> saliency;
  fluid->read_saliency(saliency);
  EXPECT_TRUE(saliency.empty()) << "before the first frame";
  fluid->look({{eye_at(ahead)}});
  for (int frame = 0; frame < 20; ++frame) fluid->step_frame();
  fluid->read_saliency(saliency);
  ASSERT_EQ(saliency.size(), static_cast<std::size_t>(fluid->particle_count()));
  bool moving = false;
  int extremes = 0;
  for (const auto& p : saliency) {
    ASSERT_GE(p.s, 0);
    ASSERT_LE(p.s, 1);
    // Grading may make a target finer than Eq. 9, never coarser.
    EXPECT_LE(p.target, std::clamp(static_cast<int>(std::floor(4 * (1 - p.s))), 0, 3));
    EXPECT_NEAR(p.combined, (p.acuity + p.manifold) / 3 + 2 * p.temporal / 3, 1e-5f * (1 + p.combined));
    moving = moving || p.temporal > 0.1f;
    extremes += p.s == 0 || p.s == 1;
  }
  EXPECT_TRUE(moving);
  EXPECT_GT(extremes, 10) << "the ends of the range must be used";
  EXPECT_EQ(fluid->report().guards.gaze_lost, 0u);
  EXPECT_EQ(fluid->report().guards.saliency_not_finite, 0u);
}
TEST(SaliencyInSimulations, PartsMakeUpTheWhole) { parts_make_up_the_whole(Backend::Cpu); }
TEST(SaliencyInSimulationsGpu, PartsMakeUpTheWhole) { parts_make_up_the_whole(Backend::Cuda); }

/// Saliency reads the neighbour lists of the last substep. A measurement of saliency between two frames
/// discards them, so that the next frame searches again. The saliency must hardly differ.
void recalled_neighbours_tell_what_a_search_tells(Backend backend) {
  for (const bool temporal : {false, true}) {
    sim::SimulationOptions options;
    options.method = temporal ? MethodKind::OursTsp : MethodKind::Ours;
    options.backend = backend;
    options.n_star = 256;
    options.temporal.fixed_tau = -6;
    double mean[2];
    double by_level[2][4] = {};
    for (const bool searched : {false, true}) {
      const auto fluid = sim::make_simulation(scene(), options);
      fluid->look({{eye_at(ahead)}});
      for (int frame = 0; frame < 6; ++frame) fluid->step_frame();
      std::vector<sim::ParticleSaliency> saliency;
      if (searched) fluid->measure_saliency({{eye_at(ahead)}}, saliency);
      fluid->step_frame();
      fluid->read_saliency(saliency);
      ASSERT_FALSE(saliency.empty());
      mean[searched] = 0;
      for (const auto& p : saliency) {
        mean[searched] += p.s / static_cast<double>(saliency.size());
        by_level[searched][p.target] += 1 / static_cast<double>(saliency.size());
      }
    }
    EXPECT_NEAR(mean[0], mean[1], 0.01 * mean[1]) << temporal;
    for (int level = 0; level < 4; ++level)
      EXPECT_NEAR(by_level[0][level], by_level[1][level], 0.01) << temporal << " level " << level;
  }
}
TEST(SaliencyInSimulations, RecalledNeighboursTellWhatASearchTells) {
  recalled_neighbours_tell_what_a_search_tells(Backend::Cpu);
}
TEST(SaliencyInSimulationsGpu, RecalledNeighboursTellWhatASearchTells) {
  recalled_neighbours_tell_what_a_search_tells(Backend::Cuda);
}

/// A run whose live numbers (saliency's alpha, iterations of the solver) are changed continues like a run
/// that was made with the new numbers.
void numbers_change_while_it_runs(Backend backend) {
  const auto changed = make(backend, MethodKind::Ours, true);
  const auto before = changed->live_numbers();
  EXPECT_NEAR(before.alpha, 2.0 / 3, 1e-12);
  for (const sim::LiveNumbers wrong : {sim::LiveNumbers{-0.1, 4},
                                       {1.1, 4},
                                       {std::numeric_limits<double>::quiet_NaN(), 4},
                                       {0.5, 0},
                                       {0.5, 65}}) {
    EXPECT_THROW(changed->change(wrong), base::Error);
  }
  EXPECT_EQ(changed->live_numbers().iterations, before.iterations) << "a refused change changes nothing";
  sim::SimulationOptions options;
  options.method = MethodKind::Ours;
  options.backend = backend;
  options.n_star = 256;
  options.readings.alpha = 0.25;
  options.iterations = 7;
  const auto made = sim::make_simulation(scene(), options);
  const auto still = make(backend, MethodKind::Ours);
  changed->change({0.25, 7});
  for (auto* fluid : {changed.get(), made.get(), still.get()}) {
    fluid->look({{eye_at(ahead)}});
    for (int frame = 0; frame < 3; ++frame) fluid->step_frame();
  }
  const auto same = [](const auto& a, const auto& b) {
    return a.id == b.id && a.x_m == b.x_m && a.y_m == b.y_m && a.level == b.level;
  };
  const auto one = changed->read_state(), other = made->read_state(), third = still->read_state();
  EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin(), other.end(), same));
  EXPECT_FALSE(std::equal(one.begin(), one.end(), third.begin(), third.end(), same));
}
TEST(SaliencyInSimulations, NumbersChangeWhileItRuns) { numbers_change_while_it_runs(Backend::Cpu); }
TEST(SaliencyInSimulationsGpu, NumbersChangeWhileItRuns) { numbers_change_while_it_runs(Backend::Cuda); }

void lost_gaze_is_counted_and_does_no_harm(Backend backend) {
  const auto fluid = make(backend, MethodKind::Ours);
  fluid->step_frame();
  EXPECT_EQ(fluid->report().guards.gaze_lost, 1u) << "nobody has said where the eye looks";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  fluid->look({{eye_at(ahead), eye_at({nan, nan, nan})}});
  for (int frame = 0; frame < 3; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->report().guards.gaze_lost, 4u) << "one of two eyes";
  EXPECT_EQ(fluid->report().guards.saliency_not_finite, 0u);
  std::vector<sim::ParticleSaliency> saliency;
  fluid->read_saliency(saliency);
  for (const auto& p : saliency) ASSERT_TRUE(p.s >= 0 && p.s <= 1);
}
TEST(SaliencyInSimulations, LostGazeIsCountedAndDoesNoHarm) {
  lost_gaze_is_counted_and_does_no_harm(Backend::Cpu);
}
TEST(SaliencyInSimulationsGpu, LostGazeIsCountedAndDoesNoHarm) {
  lost_gaze_is_counted_and_does_no_harm(Backend::Cuda);
}

void gaze_alone_has_a_fovea_and_a_periphery(Backend backend) {
  const auto fluid = make(backend, MethodKind::FovFluid);
  fluid->look({{eye_at(ahead)}});
  fluid->step_frame();
  std::vector<sim::ParticleSaliency> saliency;
  std::vector<sim::RenderParticle> places;
  fluid->read_saliency(saliency);
  fluid->read_particles(places);
  ASSERT_EQ(saliency.size(), places.size());
  int inside = 0, outside = 0;
  const auto eye = scene().view.eye_m;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double u[3] = {static_cast<double>(places[i].x_m) - eye[0],
                         static_cast<double>(places[i].y_m) - eye[1],
                         static_cast<double>(places[i].z_m) - eye[2]};
    const double away = std::hypot(u[0], u[1], u[2]);
    const double cosine = (ahead[1] * u[1] + ahead[2] * u[2]) / std::hypot(ahead[1], ahead[2]) / away;
    const double beyond = std::acos(std::min(cosine, 1.0)) - 7.5 * 0.017453292519943;
    // The particles have moved a little since the frame began.
    if (beyond * away < -0.05) {
      EXPECT_EQ(saliency[i].s, 1);
      ++inside;
    } else if (std::sin(std::min(beyond, 1.5)) * away > 4 * static_cast<double>(fluid->spacing_m()) + 0.05) {
      EXPECT_EQ(saliency[i].s, 0);
      ++outside;
    }
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(outside, 20);
}
TEST(SaliencyInSimulations, GazeAloneHasAFoveaAndAPeriphery) {
  gaze_alone_has_a_fovea_and_a_periphery(Backend::Cpu);
}
TEST(SaliencyInSimulationsGpu, GazeAloneHasAFoveaAndAPeriphery) {
  gaze_alone_has_a_fovea_and_a_periphery(Backend::Cuda);
}

void measuring_needs_no_method_and_leaves_no_trace(Backend backend) {
  const auto watched = make(backend, MethodKind::HiRes);
  const auto left_alone = make(backend, MethodKind::HiRes);
  std::vector<sim::ParticleSaliency> saliency;
  for (int frame = 0; frame < 5; ++frame) {
    watched->measure_saliency({{eye_at(ahead)}}, saliency);
    ASSERT_EQ(saliency.size(), static_cast<std::size_t>(watched->particle_count()));
    watched->step_frame();
    left_alone->step_frame();
  }
  const auto a = watched->read_state(), b = left_alone->read_state();
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].x_m, b[i].x_m);
    ASSERT_EQ(a[i].vy_m_s, b[i].vy_m_s);
  }
  int finest = 0;
  for (const auto& p : saliency) finest += p.target == 0;
  EXPECT_GT(finest, 0);
  EXPECT_LT(finest, static_cast<int>(saliency.size()) / 2);
}
TEST(SaliencyInSimulations, MeasuringNeedsNoMethodAndLeavesNoTrace) {
  measuring_needs_no_method_and_leaves_no_trace(Backend::Cpu);
}
TEST(SaliencyInSimulationsGpu, MeasuringNeedsNoMethodAndLeavesNoTrace) {
  measuring_needs_no_method_and_leaves_no_trace(Backend::Cuda);
}

bool same(const std::vector<fluid_test::ParticleState>& a, const std::vector<fluid_test::ParticleState>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
           return p.id == q.id && p.level == q.level && p.x_m == q.x_m && p.y_m == q.y_m && p.z_m == q.z_m &&
                  p.vx_m_s == q.vx_m_s && p.vy_m_s == q.vy_m_s && p.vz_m_s == q.vz_m_s;
         });
}

void saccades_split_no_more_than_the_cap(Backend backend) {
  // S21: the gaze jumps between two points 45 degrees apart at 450 degrees/s, in 6 frames each, then rests
  // for 12.
  const auto fluid = make(backend, MethodKind::Ours);
  std::uint64_t before = 0, most = 0;
  for (int frame = 0; frame < 72; ++frame) {
    const double way = std::clamp(frame % 18 / 6.0, 0.0, 1.0);
    const double angle = 0.3927 * (frame / 18 % 2 ? 1 - 2 * way : 2 * way - 1);
    const auto count = static_cast<std::uint64_t>(fluid->particle_count());
    fluid->look({{eye_at({4 * std::sin(angle), -0.6, -4 * std::cos(angle)})}});
    fluid->step_frame();
    const auto splits = fluid->report().levels.splits;
    EXPECT_LE(splits - before, (count * 5 + 99) / 100) << frame;
    most = std::max(most, splits - before);
    before = splits;
  }
  EXPECT_GT(most, 0u) << "without a split the cap has not been tried";
  for (const auto& p : fluid->read_state()) ASSERT_TRUE(std::isfinite(p.x_m + p.y_m + p.z_m));
}
TEST(SaliencyInSimulations, SaccadesSplitNoMoreThanTheCap) {
  saccades_split_no_more_than_the_cap(Backend::Cpu);
}
TEST(SaliencyInSimulationsGpu, SaccadesSplitNoMoreThanTheCap) {
  saccades_split_no_more_than_the_cap(Backend::Cuda);
}

void a_blink_leaves_no_trace(Backend backend) {
  // S21: the tracker loses the eye for 12 frames, 0.2 s; the gaze is held, so the result must be the same.
  const auto steady = make(backend, MethodKind::Ours), blinking = make(backend, MethodKind::Ours);
  for (int frame = 0; frame < 30; ++frame) {
    steady->look({{eye_at(ahead)}});
    auto eye = eye_at(ahead);
    if (frame >= 10 && frame < 22) eye.gaze = {{}, {0, 0, std::numeric_limits<double>::quiet_NaN()}, false};
    blinking->look({{eye}});
    steady->step_frame();
    blinking->step_frame();
  }
  EXPECT_TRUE(same(steady->read_state(), blinking->read_state()));
  EXPECT_EQ(blinking->report().guards.gaze_lost, 12u);
}
TEST(SaliencyInSimulations, ABlinkLeavesNoTrace) { a_blink_leaves_no_trace(Backend::Cpu); }
TEST(SaliencyInSimulationsGpu, ABlinkLeavesNoTrace) { a_blink_leaves_no_trace(Backend::Cuda); }

void the_second_eye_counts(Backend backend) {
  const auto one = make(backend, MethodKind::Ours), twice = make(backend, MethodKind::Ours);
  const auto two = make(backend, MethodKind::Ours);
  for (int frame = 0; frame < 20; ++frame) {
    one->look({{eye_at(ahead)}});
    twice->look({{eye_at(ahead), eye_at(ahead)}});
    two->look({{eye_at(ahead), eye_at({-1.6, -0.6, -4})}});
    for (const auto* fluid : {&one, &twice, &two}) (*fluid)->step_frame();
  }
  EXPECT_TRUE(same(one->read_state(), twice->read_state())) << "the same eye twice is one eye";
  EXPECT_FALSE(same(one->read_state(), two->read_state()));
}
TEST(SaliencyInSimulations, TheSecondEyeCounts) { the_second_eye_counts(Backend::Cpu); }
TEST(SaliencyInSimulationsGpu, TheSecondEyeCounts) { the_second_eye_counts(Backend::Cuda); }

TEST(SaliencyInSimulations, DoesNotDependOnTheNumberOfThreads) {
  std::vector<sim::ParticleSaliency> by_threads[2];
  const int usual = omp_get_max_threads();
  for (int k = 0; k < 2; ++k) {
    omp_set_num_threads(k == 0 ? 1 : 3);
    const auto fluid = make(Backend::Cpu, MethodKind::Ours, true);
    fluid->look({{eye_at(ahead)}});
    for (int frame = 0; frame < 5; ++frame) fluid->step_frame();
    fluid->read_saliency(by_threads[k]);
  }
  omp_set_num_threads(usual);
  ASSERT_EQ(by_threads[0].size(), by_threads[1].size());
  for (std::size_t i = 0; i < by_threads[0].size(); ++i) {
    ASSERT_EQ(by_threads[0][i].s, by_threads[1][i].s);
    ASSERT_EQ(by_threads[0][i].combined, by_threads[1][i].combined);
  }
}

}  // namespace
