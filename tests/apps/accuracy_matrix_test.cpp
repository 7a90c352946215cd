/// vip-bench accuracy: the cells of a sweep and their settings.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "libsim/setting/named_scenes.hpp"
#include "libstudy/sweep/matrix.hpp"

namespace apps {
namespace {

TEST(AccuracyMatrix, NoSettingStandsTwiceAndTheReferenceIsFirst) {
  const study::SweepPlan plan;
  const auto cells = study::cells_of(plan);
  std::set<std::string> keys;
  for (const auto& cell : cells) keys.insert(study::key_of(cell, "scene", "program"));
  EXPECT_EQ(keys.size(), cells.size());
  EXPECT_EQ(cells[0].setting, study::reference_setting("SingleDam", 4096));
  EXPECT_EQ(cells[1].setting, cells[0].setting);
  EXPECT_EQ(cells[1].seed, 2);
  std::set<std::string> settings;
  for (const auto& cell : cells) settings.insert(sim::to_text(cell.setting));
  EXPECT_GE(settings.size(), 80u);
  EXPECT_LE(settings.size(), 120u);
}

TEST(AccuracyMatrix, TheQuarterOfTheFactorialIsBalanced) {
  std::map<std::array<double, 3>, std::set<double>> levels;
  std::map<double, int> each;
  for (const auto& cell : study::cells_of({.seeds = 1})) {
    const auto& s = cell.setting;
    const auto usual = sim::usual_setting("SingleDam", sim::MethodKind::Ours, 4096);
    bool others = s.method == sim::MethodKind::Ours && s[sim::SolverKnob::Substeps] > 0;
    for (const auto knob : {sim::SolverKnob::Rate, sim::SolverKnob::CoarseCycles, sim::SolverKnob::Momentum,
                            sim::SolverKnob::Alpha, sim::SolverKnob::Fovea, sim::SolverKnob::Beta})
      others = others && s[knob] == usual[knob];
    if (others)
      levels[{s[sim::SolverKnob::Size], s[sim::SolverKnob::Iterations], s[sim::SolverKnob::Substeps]}].insert(
          s[sim::SolverKnob::Levels]);
  }
  EXPECT_EQ(levels.size(), 36u) << "4 sizes, 3 numbers of projections, 3 of substeps";
  // Each combination of size, projections and substeps occurs with one number of levels. At the usual size
  // and number of projections a second number of levels may occur, from the settings that change a single
  // knob. Each number of levels has about a quarter of the other 33 combinations.
  for (const auto& [combination, found] : levels) {
    const bool turned_alone = combination[0] == 4096 && combination[1] == 4;
    EXPECT_LE(found.size(), turned_alone ? 2u : 1u);
    if (!turned_alone) ++each[*found.begin()];
  }
  for (const auto& [level, count] : each) EXPECT_NEAR(count, 33 / 4.0, 1) << level;
}

TEST(AccuracyMatrix, AKeyNamesEverythingThatACellDependsOn) {
  const study::SweepCell cell{sim::usual_setting("SingleDam", sim::MethodKind::Ours, 1024), 1, 2, ""};
  std::set<std::string> keys{study::key_of(cell, "scene", "program"),
                             study::key_of(cell, "other scene", "program"),
                             study::key_of(cell, "scene", "other program")};
  for (const auto& traits : sim::solver_knobs()) {
    auto other = cell;
    other.setting[traits.knob] += 1;
    keys.insert(study::key_of(other, "scene", "program"));
  }
  for (const int what : {0, 1, 2, 3}) {
    auto other = cell;
    if (what == 0) other.seed = 2;
    if (what == 1) other.seconds = 3;
    if (what == 2) other.size = "640x360";
    if (what == 3) other.setting.method = sim::MethodKind::HiRes;
    keys.insert(study::key_of(other, "scene", "program"));
  }
  EXPECT_EQ(keys.size(), 3 + sim::solver_knob_count + 4);
  auto hires = sim::usual_setting("SingleDam", sim::MethodKind::HiRes, 1024), same = hires;
  same[sim::SolverKnob::Levels] = 2;
  EXPECT_EQ(sim::to_text(hires), sim::to_text(same)) << "HiRes has no levels to number";
}

TEST(AccuracyMatrix, TheUsualSettingIsWhatTheProgramsHave) {
  const auto scene = sim::scenes_of("SingleDam").front().scene;
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::Ours}) {
    auto usual = sim::to_options(sim::usual_setting("SingleDam", method, 64), sim::Backend::Cpu, 1);
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
