/// A tank that drains through a hole in its floor: Torricelli's law.

#include "tests/truth/truth_helpers.hpp"

namespace {

using namespace truth_test;

/// sqrt(h) falls linearly, by Cd sqrt(g / 2) A_hole / A_tank a second. Cd is fitted, because the hole is only
/// some spacings wide.
void tank_drains(Run run, const TruthFile& file, int across) {
  const double width = 0.6, d = width / across, height = 2 * width, hole = width / 3;
  const State start = settled(run.backend, {width, height, width}, d, 40);
  auto scene = fluid_test::tank({width, 2 * height, width}, {});
  scene.outlets.push_back({sim::Wall::Floor, {hole, hole}, {2 * hole, 2 * hole}});
  const auto fluid = start_from(run, scene, d, start);
  std::vector<double> time, root, level;
  double left = 1;
  while (left > 0.4 && fluid->frame() < 900) {
    fluid->step_frame();
    left = total_mass(fluid->read_state()) / static_cast<double>(start.size());
    if (left > 0.95) continue;  // the jet is still starting
    time.push_back(fluid->frame() * scene.frame_dt_s);
    level.push_back(left);
    root.push_back(std::sqrt(left));
  }
  EXPECT_LE(left, 0.4) << file.name() << ", " << run.name();
  const Line line = fit(time, root);
  // h / h0 = (1 - (t + t0) / T)^2, with T in `whole` and t0 in `shift`.
  const double whole = -1 / line.slope, shift = whole * (1 - line.intercept);
  double off = 0;
  for (std::size_t i = 0; i < time.size(); ++i)
    off = std::max(off, std::abs(level[i] - interpolate(file.column("t_over_T"), file.column("h_over_h0"),
                                                        (time[i] + shift) / whole)));
  const double discharge = width * width / (hole * hole) * std::sqrt(2 * height / gravity) / whole;
  std::printf(
      "%s, %s, hole of %.0f spacings: R^2 of sqrt(h) over t %.5f, Cd %.3f, h / h0 off by %.4f at most; %lld "
      "particles of %zu at last\n",
      file.name().c_str(), run.name().c_str(), hole / d, line.r2, discharge, off,
      static_cast<long long>(fluid->particle_count()), start.size());
  expect_within(1 - line.r2, file.gate("gate", run.ours()), file.name() + ", " + run.name());
  EXPECT_GT(discharge, 0.4) << file.name() << ", " << run.name();
  EXPECT_LT(discharge, 1) << file.name() << ", " << run.name();
}

void tanks_drain(Run run, int across) {
  const auto files = truth_of("draining");
  if (files.empty()) GTEST_SKIP() << "no file of a draining tank";
  for (const auto& file : files) tank_drains(run, file, across);
}
TEST(TruthDrain, HiResFollowsTorricelli) { tanks_drain({Backend::Cpu, MethodKind::HiRes}, 12); }
TEST(TruthDrain, OursFollowsTorricelli) { tanks_drain({Backend::Cpu, MethodKind::Ours}, 12); }
TEST(TruthDrainGpu, HiResFollowsTorricelli) { tanks_drain({Backend::Cuda, MethodKind::HiRes}, 48); }
TEST(TruthDrainGpu, OursFollowsTorricelli) { tanks_drain({Backend::Cuda, MethodKind::Ours}, 48); }

/// Share of the water that falls through four holes of 1.4 spacings in a second.
double share_through_narrow_holes(Run run, int across) {
  const double width = 0.6, d = width / across, height = 2 * width, hole = 1.4 * d;
  const State start = settled(run.backend, {width, height, width}, d, 40);
  auto scene = fluid_test::tank({width, 2 * height, width}, {});
  for (const double x : {0.25 * width, 0.75 * width})
    for (const double z : {0.25 * width, 0.75 * width})
      scene.outlets.push_back({sim::Wall::Floor, {x, z}, {x + hole, z + hole}});
  const auto fluid = start_from(run, scene, d, start);
  while (fluid->time_s() < 1) fluid->step_frame();
  const double left = total_mass(fluid->read_state()) / static_cast<double>(start.size());
  std::printf("four holes of 1.4 spacings, %s: %.3f of the water falls through in a second\n",
              run.name().c_str(), 1 - left);
  return 1 - left;
}
void narrow_holes_pass_alike(Backend backend, int across) {
  const double fine = share_through_narrow_holes({backend, MethodKind::HiRes}, across);
  const double levels = share_through_narrow_holes({backend, MethodKind::Ours}, across);
  EXPECT_GT(levels, 0.85 * fine);
  EXPECT_LT(levels, 1.15 * fine);
}
TEST(TruthDrain, NarrowHolesPassAsMuchUnderOurs) { narrow_holes_pass_alike(Backend::Cpu, 12); }
TEST(TruthDrainGpu, NarrowHolesPassAsMuchUnderOurs) { narrow_holes_pass_alike(Backend::Cuda, 24); }

}  // namespace
