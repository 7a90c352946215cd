/// S16: a scene far from the world's origin behaves like the scene at the origin.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "stats/base/error.hpp"
#include "tests/stability/stability_helpers.hpp"

namespace {

using namespace stability_test;
using sim::MethodKind;

constexpr double height = 1.2;

std::string numbers(std::initializer_list<double> values) {
  std::string out = "[";
  for (const double value : values) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    out += (out.size() > 1 ? ", " : "") + std::string(text);
    if (std::string(text).find_first_of(".e") == std::string::npos) out += ".0";
  }
  return out + "]";
}

/// A dam with a nozzle, an outlet, a central force, a visible box and a gaze, whose tank's low corner lies at
/// x, y, z in the world.
std::string text_at(double x, double y, double z, bool moved = true) {
  const double ox = moved ? x : 0, oy = moved ? y : 0, oz = moved ? z : 0;
  const auto at = [&](double a, double b, double c) { return numbers({ox + a, oy + b, oz + c}); };
  return "format = 1\nname = \"Far\"\ngravity_m_s2 = 9.81\ncheckpoints = []\n"
         "[tank]\nsize_m = [2.4, 2.4, 1.2]\norigin_m = " +
         numbers({x, y, z}) + "\n[water]\nmin_m = " + at(0, 0, 0) + "\nmax_m = " + at(1.2, height, 1.2) +
         "\ngate = false\nsettle_frames = 0\n"
         "[time]\nframes_per_s = 60.0\nv_ref_m_s = 6.0\nmin_substeps = 2\niterations = 4\n"
         "[[nozzle]]\ndiameter_m = 0.5\nposition_m = " +
         at(1.8, 1.8, 0.6) +
         "\nspeed_m_s = 4.0\non_frames = 10\noff_frames = 5\n[recirculation]\ncorner_m = 0.3\n"
         "[[outlet]]\nwall = \"x_high\"\nmin_m = " +
         numbers({oy + 0, oz + 0}) + "\nmax_m = " + numbers({oy + 0.3, oz + 1.2}) +
         "\n[central_force]\nomega_per_s = 0.5\ncentre_m = " + at(1.2, 0, 0.6) +
         "\naxis = [0.0, 1.0, 0.0]\n[view]\neye_m = " + at(1.2, 1, 4) + "\ntarget_m = " + at(1.2, 0.5, 0.6) +
         "\nvertical_fov_deg = 60.0\nnear_m = 0.1\n[[visible]]\nname = \"dam\"\nmin_m = " + at(0, 0, 0) +
         "\nmax_m = " + at(1, 1, 1) + "\n[[gaze]]\nframe = 0\npoint_m = " + at(0.5, 0.4, 0.3) + "\n";
}

TEST(S16FarOrigin, EveryPlaceCountsFromTheTanksCorner) {
  const auto near = sim::parse_scene(text_at(0, 0, 0), "scene.toml");
  const auto far = sim::parse_scene(text_at(1000, -200, 1e4), "scene.toml");
  EXPECT_EQ(far.origin_m, (sim::Vec3d{1000, -200, 1e4}));
  const auto same = [](const sim::Vec3d& a, const sim::Vec3d& b) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-11);
  };
  same(near.tank_size_m, far.tank_size_m);
  same(near.water.front().min_m, far.water.front().min_m);
  same(near.water.front().max_m, far.water.front().max_m);
  same(near.nozzles[0].position_m, far.nozzles[0].position_m);
  same(near.view.eye_m, far.view.eye_m);
  same(near.view.target_m, far.view.target_m);
  same(near.overview.eye_m, far.overview.eye_m);
  same(near.visible[0].min_m, far.visible[0].min_m);
  same(near.visible[0].max_m, far.visible[0].max_m);
  same(near.gaze[0].point_m, far.gaze[0].point_m);
  same(near.central_force->centre_m, far.central_force->centre_m);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_NEAR(near.outlets[0].min_m[a], far.outlets[0].min_m[a], 1e-11);
    EXPECT_NEAR(near.outlets[0].max_m[a], far.outlets[0].max_m[a], 1e-11);
  }
}

TEST(S16FarOrigin, PlacesThatDoNotGoWithTheOriginAreAnError) {
  const auto error_of = [](const std::string& text) -> std::string {
    try {
      sim::parse_scene(text, "scene.toml");
    } catch (const base::Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(error_of(text_at(1000, 0, 0)), "no error");
  EXPECT_THAT(error_of(text_at(1000, 0, 0, false)),
              testing::AllOf(testing::HasSubstr("outside the tank"), testing::HasSubstr("tank.origin_m")));
  EXPECT_THAT(error_of(text_at(1e7, 0, 0)), testing::HasSubstr("origin_m"));
}

/// Centre of mass, m, and drained mass after 40 frames.
struct Outcome {
  double x = 0, y = 0, z = 0;
  std::int64_t drained = 0;
};

Outcome after_40_frames(Backend backend, MethodKind method, double away) {
  const auto scene = sim::parse_scene(text_at(away, away, away), "scene.toml");
  sim::SimulationOptions options;
  options.backend = backend;
  options.method = method;
  options.n_star = 128;
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 40; ++frame) fluid->step_frame();
  Outcome out;
  double mass = 0;
  for (const auto& p : fluid->read_state()) {
    const double m = 1 << p.level;
    mass += m;
    out.x += m * static_cast<double>(p.x_m);
    out.y += m * static_cast<double>(p.y_m);
    out.z += m * static_cast<double>(p.z_m);
  }
  out.x /= mass;
  out.y /= mass;
  out.z /= mass;
  out.drained = fluid->report().drained;
  return out;
}

void runs_as_at_the_origin(Backend backend) {
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours}) {
    SCOPED_TRACE(sim::method_name(method));
    const Outcome near = after_40_frames(backend, method, 0);
    EXPECT_GT(near.drained, 0);
    for (const double away : {1e2, 1e3, 1e4}) {
      const Outcome far = after_40_frames(backend, method, away);
      const double error =
          std::max({std::abs(far.x - near.x), std::abs(far.y - near.y), std::abs(far.z - near.z)});
      std::printf("S16 %s at %g m: %.2e of the height\n", sim::method_name(method).c_str(), away,
                  error / height);
      EXPECT_LT(error, 1e-3 * height) << away;
    }
  }
}
TEST(S16FarOrigin, RunsAsAtTheOrigin) { runs_as_at_the_origin(Backend::Cpu); }
TEST(S16FarOriginGpu, RunsAsAtTheOrigin) { runs_as_at_the_origin(Backend::Cuda); }

}  // namespace
