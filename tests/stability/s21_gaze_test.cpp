/// Water at rest under a gaze at rest: pairs of unlike levels, stirring. Jumps are a case of libsim/cases
/// (S21).

#include <cstdio>

#include "tests/libsim/levels_helpers.hpp"

namespace {

using namespace levels_test;
using sim::MethodKind;
using sim::Vec3d;

constexpr std::int64_t n_star = 512;  // 4,096 finest particles

/// A pool of 8 finest layers, seen from in front of it.
sim::Scene pool() {
  auto out = fluid_test::tank({4.8, 4, 2.4}, {4.8, 1.2, 2.4}, 60);
  out.view.eye_m = {2.4, 1.6, 5.2};
  out.view.target_m = {2.4, 0.6, 1.2};
  return out;
}
const Vec3d left{1.2, 0.6, 1.2};

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
