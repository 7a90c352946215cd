/// vip-bench accuracy: the cells of a sweep and their settings.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "apps/common/named_scenes.hpp"
#include "apps/common/sweep/matrix.hpp"

namespace apps {
namespace {

TEST(AccuracyMatrix, NoSettingStandsTwiceAndTheReferenceIsFirst) {
  const SweepPlan plan;
  const auto cells = cells_of(plan);
  std::set<std::string> keys;
  for (const auto& cell : cells) keys.insert(key_of(cell, "scene", "program"));
  EXPECT_EQ(keys.size(), cells.size());
  EXPECT_EQ(cells[0].setting, reference_setting("SingleDam", 4096));
  EXPECT_EQ(cells[1].setting, cells[0].setting);
  EXPECT_EQ(cells[1].seed, 2);
  std::set<std::string> settings;
  for (const auto& cell : cells) settings.insert(to_text(cell.setting));
  EXPECT_GE(settings.size(), 80u);
  EXPECT_LE(settings.size(), 120u);
}

TEST(AccuracyMatrix, TheQuarterOfTheFactorialIsBalanced) {
  std::map<std::array<double, 3>, std::set<double>> levels;
  std::map<double, int> each;
  for (const auto& cell : cells_of({.seeds = 1})) {
    const auto& s = cell.setting;
    const auto usual = usual_setting("SingleDam", sim::MethodKind::Ours, 4096);
    bool others = s.method == sim::MethodKind::Ours && s[SolverKnob::Substeps] > 0;
    for (const auto knob : {SolverKnob::Rate, SolverKnob::CoarseCycles, SolverKnob::Momentum,
                            SolverKnob::Alpha, SolverKnob::Fovea, SolverKnob::Beta})
      others = others && s[knob] == usual[knob];
    if (others)
      levels[{s[SolverKnob::Size], s[SolverKnob::Iterations], s[SolverKnob::Substeps]}].insert(
          s[SolverKnob::Levels]);
  }
  EXPECT_EQ(levels.size(), 36u) << "4 sizes, 3 numbers of projections, 3 of substeps";
  // Settings that change one knob at the usual size and projections come in addition to the quarter.
  for (const auto& [combination, found] : levels) {
    const bool turned_alone = combination[0] == 4096 && combination[1] == 4;
    EXPECT_LE(found.size(), turned_alone ? 2u : 1u);
    if (!turned_alone) ++each[*found.begin()];
  }
  for (const auto& [level, count] : each) EXPECT_NEAR(count, 33 / 4.0, 1) << level;
}

TEST(AccuracyMatrix, AKeyNamesEverythingThatACellDependsOn) {
  const SweepCell cell{usual_setting("SingleDam", sim::MethodKind::Ours, 1024), 1, 2, ""};
  std::set<std::string> keys{key_of(cell, "scene", "program"), key_of(cell, "other scene", "program"),
                             key_of(cell, "scene", "other program")};
  for (const auto& traits : solver_knobs()) {
    auto other = cell;
    other.setting[traits.knob] += 1;
    keys.insert(key_of(other, "scene", "program"));
  }
  for (const int what : {0, 1, 2, 3}) {
    auto other = cell;
    if (what == 0) other.seed = 2;
    if (what == 1) other.seconds = 3;
    if (what == 2) other.size = "640x360";
    if (what == 3) other.setting.method = sim::MethodKind::HiRes;
    keys.insert(key_of(other, "scene", "program"));
  }
  EXPECT_EQ(keys.size(), 3 + solver_knob_count + 4);
  auto hires = usual_setting("SingleDam", sim::MethodKind::HiRes, 1024), same = hires;
  same[SolverKnob::Levels] = 2;
  EXPECT_EQ(to_text(hires), to_text(same)) << "HiRes has no levels to number";
}

TEST(AccuracyMatrix, TheUsualSettingIsWhatTheProgramsHave) {
  const auto scene = scenes_of("SingleDam").front().scene;
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    auto usual = to_options(usual_setting("SingleDam", method, 64), sim::Backend::Cpu, 1);
    usual.cache.clear();
    sim::SimulationOptions plain;
    plain.method = method;
    plain.n_star = 64;
    const auto a = sim::make_simulation(scene, usual), b = sim::make_simulation(scene, plain);
    for (int frame = 0; frame < 10; ++frame) {
      a->step_frame();
      b->step_frame();
    }
    const auto first = a->read_state(), second = b->read_state();
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      ASSERT_EQ(first[i].x_m, second[i].x_m) << sim::method_name(method);
      ASSERT_EQ(first[i].vy_m_s, second[i].vy_m_s) << sim::method_name(method);
    }
  }
}

}  // namespace
}  // namespace apps
