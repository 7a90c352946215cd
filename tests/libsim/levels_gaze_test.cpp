/// Levels that follow the eye, over water at rest: jumps of the gaze, a gaze that is lost, pairs of unlike
/// levels, stirring (S10, S21), on the CPU and on CUDA.

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
TEST(LevelsAndGaze, JumpsAreFollowed) { gaze_jumps_are_followed(Backend::Cpu); }
TEST(LevelsAndGazeGpu, JumpsAreFollowed) { gaze_jumps_are_followed(Backend::Cuda); }

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
TEST(LevelsAndGaze, ALostGazeReturns) { lost_gaze_returns(Backend::Cpu); }
TEST(LevelsAndGazeGpu, ALostGazeReturns) { lost_gaze_returns(Backend::Cuda); }

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
TEST(LevelsAndGaze, StillWaterStaysCalm) { still_water_stays_calm(Backend::Cpu); }
TEST(LevelsAndGazeGpu, StillWaterStaysCalm) { still_water_stays_calm(Backend::Cuda); }

/// A sheet of n x n sites and `layers` layers, its lowest corner at `low`.
std::vector<ParticleState> sheet(int n, int layers, const Vec3d& low, int first_id) {
  std::vector<ParticleState> out;
  for (int i = 0; i < n * n * layers; ++i) {
    const auto at = [&](std::size_t axis, int k) { return static_cast<float>(low[axis] + d * k); };
    out.push_back({first_id + i, 0, at(0, i % n), at(1, i / n / n), at(2, i / n % n), 0, 0, 0});
  }
  return out;
}

void sheets_do_not_merge_from_afar(Backend backend) {
  // S10: whoever vanishes in a merge lay within one radius of what it became.
  auto scene = fluid_test::tank({8, 8, 8}, {12 * d, 16 * d, 12 * d});
  scene.gravity_m_s2 = 0;
  for (const int layers : {1, 2}) {
    auto options = options_for(backend, 288, everywhere(3));
    options.start = sheet(16, layers, {3, 4, 3}, 0);
    const auto fluid = sim::make_simulation(scene, options);
    auto before = *options.start;
    int merges = 0;
    for (int frame = 0; frame < 60; ++frame) {
      fluid->step_frame();
      const auto after = fluid->read_state();
      std::map<int, ParticleState> now;
      for (const auto& p : after) now[p.id] = p;
      std::vector<ParticleState> merged;
      for (const auto& p : before) {
        if (now.count(p.id) && now[p.id].level > p.level) merged.push_back(now[p.id]);
      }
      for (const auto& p : before) {
        if (now.count(p.id)) continue;
        ++merges;
        double nearest = far_m;
        for (const auto& q : merged) {
          if (q.level != p.level + 1) continue;
          nearest =
              std::min(nearest, static_cast<double>(std::hypot(q.x_m - p.x_m, q.y_m - p.y_m, q.z_m - p.z_m)));
        }
        const double radius = 0.5 * d * std::cbrt(2 << p.level);
        ASSERT_LT(nearest, 1.1 * radius) << "layers " << layers << ", frame " << frame << ", id " << p.id;
      }
      before = after;
    }
    EXPECT_GT(merges, 50) << layers;
  }
}
TEST(ThinSheet, DoesNotMergeFromAfar) { sheets_do_not_merge_from_afar(Backend::Cpu); }
TEST(ThinSheetGpu, DoesNotMergeFromAfar) { sheets_do_not_merge_from_afar(Backend::Cuda); }

/// Area, m2, that the sheet's particles cover as they are drawn, 1.5 radii wide, seen from above.
double covered_m2(const std::vector<ParticleState>& state, double above_m) {
  constexpr double cell = d / 4;
  constexpr int side = 128;
  std::vector<char> covered(side * side, 0);
  for (const auto& p : state) {
    if (static_cast<double>(p.y_m) < above_m) continue;
    const double r = 1.5 * 0.5 * d * std::cbrt(1 << p.level);
    for (int k = 0; k < side * side; ++k) {
      const double x = (k % side + 0.5) * cell - static_cast<double>(p.x_m);
      const double z = (k / side + 0.5) * cell - static_cast<double>(p.z_m);
      if (x * x + z * z < r * r) covered[static_cast<std::size_t>(k)] = 1;
    }
  }
  return static_cast<double>(std::count(covered.begin(), covered.end(), 1)) * cell * cell;
}

void sheets_keep_their_area(Backend backend) {
  // S10: a sheet that falls towards a pool for 0.3 s, away from the gaze, against HiRes.
  const auto water = settled_pool(backend);
  for (const int layers : {1, 2}) {
    auto start = water;
    const auto thrown = sheet(12, layers, {2.8, 2.6, 0.4}, static_cast<int>(start.size()));
    start.insert(start.end(), thrown.begin(), thrown.end());
    sim::SimulationOptions options;
    options.n_star = n_star;
    options.backend = backend;
    options.start = start;
    options.particle_capacity = static_cast<std::int64_t>(start.size());
    const auto fine = sim::make_simulation(pool(), options);
    options.method = MethodKind::Ours;
    const auto ours = sim::make_simulation(pool(), options);
    double least = 1;
    for (int frame = 1; frame <= 18; ++frame) {
      look_at(*ours, left);
      ours->step_frame();
      fine->step_frame();
      if (frame % 6 == 0)
        least = std::min(least, covered_m2(ours->read_state(), 1.7) / covered_m2(fine->read_state(), 1.7));
    }
    std::printf("sheet of %d layers: covers at least %.3f of HiRes' area\n", layers, least);
    EXPECT_GT(covered_m2(fine->read_state(), 1.7), 2);
    EXPECT_GT(least, 0.9);
  }
}
TEST(ThinSheet, KeepsItsArea) { sheets_keep_their_area(Backend::Cpu); }
TEST(ThinSheetGpu, KeepsItsArea) { sheets_keep_their_area(Backend::Cuda); }

}  // namespace
