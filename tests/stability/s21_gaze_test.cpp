/// Levels that follow the eye, over water at rest: jumps of the gaze, a gaze that is lost, pairs of unlike
/// levels, stirring (S21), on the CPU and on CUDA.

#include <cstdio>

#include "tests/libsim/levels_helpers.hpp"

namespace {

using namespace levels_test;
using sim::MethodKind;
using sim::Vec3d;

constexpr std::int64_t n_star = 512;  // 4,096 finest particles
constexpr double fovea = 7.5 * 3.14159265358979 / 180;

/// A pool of 8 finest layers, seen from in front of it.
sim::Scene pool() {
  auto out = fluid_test::tank({4.8, 4, 2.4}, {4.8, 1.2, 2.4}, 60);
  out.view.eye_m = {2.4, 1.6, 5.2};
  out.view.target_m = {2.4, 0.6, 1.2};
  return out;
}
const Vec3d left{1.2, 0.6, 1.2};
const Vec3d right{3.6, 0.6, 1.2};

std::vector<ParticleState> settled_pool(Backend backend) {
  sim::SimulationOptions options;
  options.n_star = n_star;
  options.backend = backend;
  return sim::make_simulation(pool(), options)->read_state();
}

std::unique_ptr<sim::Simulation> follow(Backend backend, MethodKind method,
                                        const std::vector<ParticleState>& start) {
  sim::SimulationOptions options;
  options.method = method;
  options.n_star = n_star;
  options.backend = backend;
  options.start = start;
  return sim::make_simulation(pool(), options);
}

Vec3d from_eye(const Vec3d& point) {
  const auto eye = pool().view.eye_m;
  return {point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]};
}

void look_at(sim::Simulation& fluid, const Vec3d& point, bool valid = true) {
  const auto scene = pool();
  fluid.look({{{{scene.view.eye_m, from_eye(point), valid}, sim::make_view(scene.view, 320, 240), nullptr}}});
}

/// Share of the mass in the fovea round `point` that is as fine as its target or finer.
double foveal_share(const sim::Simulation& fluid, const Vec3d& point) {
  std::vector<sim::ParticleSaliency> saliency;
  std::vector<sim::RenderParticle> places;
  fluid.read_saliency(saliency);
  fluid.read_particles(places);
  const Vec3d g = from_eye(point);
  double mass = 0;
  double there = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3d u = from_eye({static_cast<double>(places[i].x_m), static_cast<double>(places[i].y_m),
                              static_cast<double>(places[i].z_m)});
    const double cosine = (u[0] * g[0] + u[1] * g[1] + u[2] * g[2]) / std::hypot(u[0], u[1], u[2]) /
                          std::hypot(g[0], g[1], g[2]);
    if (cosine < std::cos(fovea)) continue;
    const auto level =
        std::lround(3 * std::log2(2 * static_cast<double>(places[i].radius_m) / fluid.spacing_m()));
    const double m = 1 << level;
    mass += m;
    if (level <= saliency[i].target) there += m;
  }
  EXPECT_GT(mass, 100) << "the fovea must hold water for the test to mean anything";
  return there / mass;
}

/// Frames until 90 % of the fovea's mass is where it should be; `most` + 1 when it never is.
int frames_to_follow(sim::Simulation& fluid, const Vec3d& point, int most) {
  for (int frame = 1; frame <= most; ++frame) {
    look_at(fluid, point);
    fluid.step_frame();
    if (foveal_share(fluid, point) >= 0.9) return frame;
  }
  return most + 1;
}

void gaze_jumps_are_followed(Backend backend) {
  const auto start = settled_pool(backend);
  for (const auto method : {MethodKind::FovFluid, MethodKind::Ours}) {
    const auto fluid = follow(backend, method, start);
    for (int frame = 0; frame < 60; ++frame) {
      look_at(*fluid, left);
      fluid->step_frame();
    }
    const auto coarse = fluid->particle_count();
    EXPECT_LT(coarse, 8 * n_star * 3 / 4) << "the periphery must have become coarse";
    const int frames = frames_to_follow(*fluid, right, 20);
    std::printf("%s: fovea at its target %d frames after a jump of the gaze, from %lld particles\n",
                sim::method_name(method).c_str(), frames, static_cast<long long>(coarse));
    EXPECT_LE(frames, 20);
  }
}
TEST(S21Gaze, JumpsAreFollowed) { gaze_jumps_are_followed(Backend::Cpu); }
TEST(S21GazeGpu, JumpsAreFollowed) { gaze_jumps_are_followed(Backend::Cuda); }

void lost_gaze_returns(Backend backend) {
  // S21: the gaze is held for 0.5 s and then goes to the view's axis for 0.5 s; back within 10 frames.
  const auto fluid = follow(backend, MethodKind::FovFluid, settled_pool(backend));
  for (int frame = 0; frame < 60; ++frame) {
    look_at(*fluid, left);
    fluid->step_frame();
  }
  for (int frame = 0; frame < 60; ++frame) {
    look_at(*fluid, left, false);
    fluid->step_frame();
  }
  EXPECT_EQ(fluid->report().guards.gaze_lost, 60u);
  EXPECT_LT(foveal_share(*fluid, left), 1.01);
  const int frames = frames_to_follow(*fluid, left, 10);
  std::printf("gaze back: fovea at its target after %d frames\n", frames);
  EXPECT_LE(frames, 10);
}
TEST(S21Gaze, ALostGazeReturns) { lost_gaze_returns(Backend::Cpu); }
TEST(S21GazeGpu, ALostGazeReturns) { lost_gaze_returns(Backend::Cuda); }

double rms_speed(const std::vector<ParticleState>& state) {
  double sum = 0;
  for (const auto& p : state)
    sum +=
        (1 << p.level) * static_cast<double>(p.vx_m_s * p.vx_m_s + p.vy_m_s * p.vy_m_s + p.vz_m_s * p.vz_m_s);
  return std::sqrt(sum / static_cast<double>(mass_units(state)));
}

void still_water_stays_calm(Backend backend) {
  // Water at rest under a gaze at rest: what splits and merges set free must not feed on itself.
  struct Case {
    MethodKind method;
    double calm;  ///< share of sqrt(g d_*)
  };
  for (const Case& c : {Case{MethodKind::FovFluid, 0.25}, Case{MethodKind::Ours, 0.35}}) {
    const auto fluid = follow(backend, c.method, settled_pool(backend));
    double jumps = 0;
    double rms = 0;
    for (int frame = 1; frame <= 150; ++frame) {
      look_at(*fluid, left);
      fluid->step_frame();
      if (frame <= 90 || frame % 10) continue;
      jumps = std::max(jumps, fluid->report().jump_share);
      rms = std::max(rms, rms_speed(fluid->read_state()));
    }
    const auto events = fluid->report().levels;
    std::printf(
        "%s over still water: v_rms %.3f m/s, largest share of jumps %.4f, %llu splits, %llu merges\n",
        sim::method_name(c.method).c_str(), rms, jumps, static_cast<unsigned long long>(events.splits),
        static_cast<unsigned long long>(events.merges));
    EXPECT_LT(rms, c.calm * std::sqrt(gravity * d));
    EXPECT_LT(jumps, 0.01);
  }
}
TEST(S21Gaze, StillWaterStaysCalm) { still_water_stays_calm(Backend::Cpu); }
TEST(S21GazeGpu, StillWaterStaysCalm) { still_water_stays_calm(Backend::Cuda); }

}  // namespace
