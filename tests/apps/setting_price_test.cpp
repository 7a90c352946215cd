/// Time and error of one setting in a sweep file.
#include "libstudy/sweep/setting_price.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "apps/view/options.hpp"
#include "libsim/setting/named_scenes.hpp"
#include "tests/apps/small_dam.hpp"
#include "tests/apps/small_sweep.hpp"
#include "tests/apps/table_test_support.hpp"

namespace apps {
namespace {

using test::hires_at;
using test::small_sweep;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

const std::string& scene_sha256() {
  static const std::string out = sim::scenes_of("SingleDam").front().scene.sha256;
  return out;
}

std::string lines(const study::SettingPrices& prices) {
  std::string out;
  for (const auto& line : study::in_words(prices)) out += line + "\n";
  return out;
}

TEST(SettingPrice, IsTheRowOfExactlyThisSettingBesideHiRes) {
  const auto tables = study::sweep_tables(small_sweep());
  ASSERT_THAT(tables.tables, SizeIs(1));
  EXPECT_EQ(tables.tables[0].plan.n_star, 512);
  EXPECT_EQ(tables.tables[0].plan.seconds, 2);
  auto setting = hires_at(512);
  setting.scene = "a name of no sweep";  // the file's hash identifies the scene
  setting[sim::SolverKnob::Iterations] = 8;
  const auto prices = study::prices_of(tables, setting, scene_sha256());
  ASSERT_THAT(prices.found, SizeIs(1));
  EXPECT_EQ(prices.found[0].row->setting[sim::SolverKnob::Iterations], 8);
  ASSERT_NE(prices.found[0].hires, nullptr);
  EXPECT_EQ(prices.found[0].hires->setting, hires_at(512));
  // A frame of the usual HiRes takes 10 to 17 ms, a frame with 8 projections 14 to 21 ms.
  EXPECT_DOUBLE_EQ(prices.found[0].row->ms_mean - prices.found[0].hires->ms_mean, 4);
  EXPECT_THAT(lines(prices), AllOf(HasSubstr("17.50 ms a frame"), HasSubstr("(the solver alone)"),
                                   HasSubstr("1.30 times the time of HiRes at n_* 512 (13.50 ms)"),
                                   HasSubstr("density_pct +0.05"), HasSubstr("measured on a machine")));
}

TEST(SettingPrice, HiResItselfIsWhatOthersAreHeldAgainst) {
  const auto tables = study::sweep_tables(small_sweep());
  EXPECT_THAT(lines(study::prices_of(tables, hires_at(512), scene_sha256())),
              AllOf(HasSubstr("which others are compared with"), Not(HasSubstr("times the time"))));
}

TEST(SettingPrice, SaysWhichKnobsDifferWhereNoRowIsTheSetting) {
  const auto tables = study::sweep_tables(small_sweep());
  auto setting = hires_at(512);
  setting[sim::SolverKnob::Substeps] = 3;
  EXPECT_EQ(lines(study::prices_of(tables, setting, scene_sha256())),
            "not measured: the sweep's nearest row of HiRes differs in substeps (here 3, there 0)\n");
  setting[sim::SolverKnob::Iterations] = 8;  // the row with 8 is nearer than the usual one
  EXPECT_THAT(lines(study::prices_of(tables, setting, scene_sha256())), Not(HasSubstr("projections")));
  EXPECT_EQ(lines(study::prices_of(tables, sim::usual_setting("SingleDam", sim::MethodKind::LoRes, 512),
                                   scene_sha256())),
            "not measured: the sweep has no row of LoRes\n");
  EXPECT_THAT(lines(study::prices_of(tables, hires_at(512), "beef")),
              HasSubstr("no table of this scene file"));
}

// A beta that follows the frame rate equals the beta of no row of the sweep.
TEST(SettingPrice, ABetaThatFollowsTheFrameRateIsNoRowsBeta) {
  auto cells = small_sweep();
  auto accelerated = sim::usual_setting("SingleDam", sim::MethodKind::OursTsp, 512);
  accelerated[sim::SolverKnob::Beta] = 0.7866;
  cells.push_back(test::stored(accelerated, 1, test::run_with(1.2, 10, 5)));
  const auto tables = study::sweep_tables(cells);
  EXPECT_THAT(study::prices_of(tables, accelerated, scene_sha256()).found, SizeIs(1));
  auto live = accelerated;
  live[sim::SolverKnob::Beta] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(
      lines(study::prices_of(tables, live, scene_sha256())),
      "not measured: the sweep's nearest row of Ours-TSp differs in beta (here following the frame rate, "
      "there 0.7866)\n");
}

TEST(SettingPrice, MachinesProgramsAndScenesStayApart) {
  auto cells = small_sweep();
  const auto alone = lines(study::prices_of(study::sweep_tables(cells), hires_at(512), scene_sha256()));
  auto others = small_sweep();
  for (auto& cell : others) {
    cell.origin.machine = "another";
    for (auto& frame : cell.run.frames) frame.solve_ms *= 10;
  }
  cells.insert(cells.end(), others.begin(), others.end());
  const auto tables = study::sweep_tables(cells);
  ASSERT_THAT(tables.tables, SizeIs(2));
  const auto both = lines(study::prices_of(tables, hires_at(512), scene_sha256()));
  EXPECT_THAT(both,
              AllOf(HasSubstr(alone), HasSubstr("135.00 ms a frame"), HasSubstr("measured on another")));
}

TEST(SettingPrice, WhatMakesNoTableSaysWhy) {
  auto changed = small_sweep();
  for (auto& cell : changed) cell.origin.scene_sha256 = "feed";
  auto tables = study::sweep_tables(changed);
  EXPECT_TRUE(tables.tables.empty());
  EXPECT_THAT(tables.left_out, ElementsAre(HasSubstr("has changed since the sweep was run")));
  EXPECT_THAT(lines(study::prices_of(tables, hires_at(512), scene_sha256())),
              HasSubstr("has changed since the sweep was run"));
  auto begun = small_sweep();
  begun.erase(begun.begin());
  tables = study::sweep_tables(begun);
  EXPECT_TRUE(tables.tables.empty());
  EXPECT_THAT(tables.left_out, ElementsAre(HasSubstr("no finished reference")));
}

TEST(SettingPrice, OptionsGiveTheSettingThatTheyRun) {
  const auto scene = sim::scenes_of("SingleDam").front().scene;
  for (const auto& method : sim::all_methods()) {
    auto setting = sim::usual_setting("SingleDam", method.kind, 512);
    setting[sim::SolverKnob::Iterations] = 7;
    setting[sim::SolverKnob::Substeps] = 3;
    setting[sim::SolverKnob::CoarseCycles] = 1;
    setting[sim::SolverKnob::Momentum] = 0.25;
    setting[sim::SolverKnob::Rate] = 90;
    setting[sim::SolverKnob::Levels] = 3;
    setting[sim::SolverKnob::Alpha] = 0.5;
    setting[sim::SolverKnob::Fovea] = 10;
    setting[sim::SolverKnob::Beta] = 0.67;
    EXPECT_EQ(sim::to_text(sim::setting_of(scene, sim::to_options(setting, sim::Backend::Cpu, 1))),
              sim::to_text(setting));
  }
  sim::SimulationOptions usual;
  usual.method = sim::MethodKind::Ours;
  usual.n_star = 512;
  EXPECT_EQ(sim::to_text(sim::setting_of(scene, usual)),
            sim::to_text(sim::usual_setting("SingleDam", sim::MethodKind::Ours, 512)));
  usual.method = sim::MethodKind::OursTsp;
  EXPECT_TRUE(std::isnan(sim::setting_of(scene, usual)[sim::SolverKnob::Beta]));
}

std::string without_scene(const sim::SolverSetting& setting) {
  const std::string text = sim::to_text(setting);
  return text.substr(text.find(' '));
}

// The setting that vip-view shows in its panel and prints.
TEST(SettingInForce, IsTheFilesOrThatOfTheOptions) {
  const ::test::TemporaryFolder folder;
  base::write_file_atomically(folder / "dam.toml", test::small_dam);
  sim::SettingFile file{sim::usual_setting("SingleDam", sim::MethodKind::FovFluid, 64), {}};
  file.setting[sim::SolverKnob::Substeps] = 3;
  file.setting[sim::SolverKnob::Beta] = 0.9;
  file.measured = {.machine = "a",
                   .program = "b",
                   .scene_sha256 = "c",
                   .picture = "none",
                   .seconds = 1,
                   .budget_ms = 1,
                   .ms_mean = 1,
                   .ms_p95 = 1,
                   .error = "centre_pct",
                   .error_pct = 1,
                   .error_low_pct = 1,
                   .error_high_pct = 1,
                   .seeds = 1,
                   .date_utc = "d"};
  base::write_file_atomically(folder / "best.toml", sim::format_setting_file(file));
  ViewOptions options;
  options.scene = folder / "dam.toml";
  options.backend = "cpu";
  options.display = "headless";
  take_setting(options, folder / "best.toml");
  EXPECT_EQ(without_scene(prepare_fluid(options).setting), without_scene(file.setting));
  options.iterations = 7;  // like a choice in the panel
  const auto turned = prepare_fluid(options);
  EXPECT_EQ(turned.setting[sim::SolverKnob::Iterations], 7) << "a restart keeps it";
  EXPECT_EQ(turned.setting[sim::SolverKnob::Substeps], 3) << "beside the file's other numbers";
  options.method = "HiRes";
  const auto hires = prepare_fluid(options);
  EXPECT_EQ(hires.setting.method, sim::MethodKind::HiRes);
  EXPECT_EQ(hires.setting[sim::SolverKnob::Substeps], 0) << "the file's numbers hold no more";
  EXPECT_TRUE(price_lines(options, hires.setting, hires.scene).empty()) << "no sweep was given";
  options.sweep = std::make_shared<const study::SweepTables>(study::sweep_tables(small_sweep()));
  EXPECT_THAT(price_lines(options, hires.setting, hires.scene),
              ElementsAre(HasSubstr("no table of this scene")));
  const auto dam = sim::scenes_of("SingleDam").front().scene;
  EXPECT_THAT(price_lines(options, hires_at(512), dam), SizeIs(4));
  options.preset = "paper";
  EXPECT_THAT(price_lines(options, hires_at(512), dam), ElementsAre(HasSubstr("not the paper's")));
}

class SettingPriceE2e : public test::TableTest {
 protected:
  test::Ended view(const std::string& more) const {
    return program(
        "vip-view data/scenes/single_dam.toml --headless --n-star 64 --backend cpu --size 64x48 "
        "--frames 1 --sweep " +
        path("sweep.db") + " " + more);
  }
};

TEST_F(SettingPriceE2e, VipViewSaysWhatTheSettingInForceCostsAndErrsBy) {
  const auto swept =
      table("accuracy --quick --n-star 64 --seconds 0.2 --seeds 1 --pictures 64x36 --db " + path("sweep.db"));
  ASSERT_EQ(swept.exit_code, 0) << swept.out;
  const auto found = view("--method Ours");
  ASSERT_EQ(found.exit_code, 0) << found.out;
  EXPECT_THAT(found.out,
              AllOf(HasSubstr("sweep  "), HasSubstr(" ms a frame, 95 % within "), HasSubstr("centre_pct"),
                    HasSubstr("picture_pct"), HasSubstr("compared pictures of 64x36"),
                    HasSubstr("times the time of HiRes at n_* 64")));
  EXPECT_THAT(view("--method HiRes").out, HasSubstr("which others are compared with"));
  EXPECT_THAT(
      view("--method HiRes --iterations 5").out,
      HasSubstr(
          "sweep  not measured: the sweep's nearest row of HiRes differs in projections (here 5, there "));
  EXPECT_THAT(view("--method Ours-TSp").out, HasSubstr("beta (here following the frame rate"));
  EXPECT_THAT(view("--method Ours --preset paper").out, HasSubstr("not the paper's"));
  base::write_file_atomically(path("sweep.db"), "no sweep");
  const auto foreign = view("--method HiRes");
  EXPECT_EQ(foreign.exit_code, 1);
  EXPECT_THAT(foreign.out, HasSubstr("is not a sweep file"));
}

}  // namespace
}  // namespace apps
