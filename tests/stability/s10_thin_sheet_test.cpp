/// S10: sheets do not merge across their sides, on the CPU and on CUDA. A case of libsim/cases tests the area
/// that they cover.

#include "tests/libsim/levels_helpers.hpp"

namespace {

using namespace levels_test;
using sim::Vec3d;

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
  // S10: a particle that disappears in a merge lay within one radius of the merged particle.
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
TEST(S10ThinSheet, DoesNotMergeFromAfar) { sheets_do_not_merge_from_afar(Backend::Cpu); }
TEST(S10ThinSheetGpu, DoesNotMergeFromAfar) { sheets_do_not_merge_from_afar(Backend::Cuda); }

}  // namespace
