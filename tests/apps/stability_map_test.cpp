#include "libsim/measure/stability_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/scene/effects.hpp"
#include "tests/apps/table_test_support.hpp"
#include "tests/common/needs_effects.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two cases and two methods: limits that were found, a case that fails already with its usual settings, and
/// a case (S1) without a result for LoRes.
measure::StabilityMap small_map() {
  measure::StabilityMap out{.cases = {"S1", "S9"},
                            .methods = {"LoRes", "Ours"},
                            .cells = {},
                            .most = 4,
                            .resolution = 1.2,
                            .circumstances = "a machine, two cores; back end cpu"};
  const auto add = [&](const char* id, const char* method, measure::Knob knob, double usual, double limit,
                       measure::Reach reach, const char* failed) {
    out.cells.push_back({id, "a title, with a comma", method, knob, "s", usual, limit, reach, failed});
  };
  add("S1", "Ours", measure::Knob::FrameStep, 1.0 / 60, 2.0 / 60, measure::Reach::Found, "rho 1.3, stopped");
  add("S1", "Ours", measure::Knob::Iterations, 4, 2, measure::Reach::Found, "height|lost");
  add("S1", "Ours", measure::Knob::Scale, 1, 4, measure::Reach::AllPass, "");
  for (const measure::Knob knob : measure::all_knobs)
    add("S9", "LoRes", knob, 1, 1, measure::Reach::UsualFails, "flux 0.4 < 0.85");
  for (const measure::Knob knob : measure::all_knobs)
    add("S9", "Ours", knob, 1, 1, measure::Reach::Found, "too far");
  return out;
}

TEST(StabilityMap, MarginsAreFactorsToTheUsual) {
  const auto map = small_map();
  EXPECT_DOUBLE_EQ(measure::margin_of(map.cells[0]), 2);
  EXPECT_DOUBLE_EQ(measure::margin_of(map.cells[1]), 2) << "half the iterations";
  EXPECT_DOUBLE_EQ(measure::margin_of(map.cells[2]), 4);
  EXPECT_DOUBLE_EQ(measure::margin_of(map.cells[3]), 0) << "fails at its own numbers";
}

TEST(StabilityMap, CsvHasARowForEachNumberThatWasTurned) {
  const auto map = small_map();
  const auto table = measure::to_table(map);
  ASSERT_EQ(table.rows.size(), 9u);
  for (const auto& row : table.rows) {
    ASSERT_EQ(row.size(), table.head.size());
    for (const auto& cell : row) EXPECT_THAT(cell, Not(HasSubstr(",")));
  }
  const std::string csv = figures::to_csv(table);
  EXPECT_THAT(csv,
              HasSubstr("S1,a title; with a comma,Ours,frame_step,s,0.01667,0.03333,2.000,found,rho 1.3; "
                        "stopped,4,1.2,a machine; two cores; back end cpu\n"));
  EXPECT_THAT(csv, HasSubstr("scale,s,1,4,4.000,all_pass,,"));
  EXPECT_THAT(csv, HasSubstr("S9,a title; with a comma,LoRes,frame_step,s,1,1,0.000,default_fails,flux 0.4"));
}

TEST(StabilityMap, MarkdownHasARowForEachCaseAndMethod) {
  const std::string text = measure::to_markdown(small_map());
  EXPECT_THAT(text, HasSubstr("a machine, two cores; back end cpu"));
  EXPECT_THAT(text, HasSubstr("a factor of 1.2 at most"));
  EXPECT_THAT(text,
              HasSubstr("| S1 | Ours | 0.01667 to 0.03333 (x 2.00) | 4 to 2 (x 2.00) | 1 to 4+ (x 4.00) | "
                        "rho 1.3; stopped; height/lost; nothing |\n"));
  EXPECT_THAT(
      text, HasSubstr("| S9 | LoRes | **fails at 1** | **fails at 1** | **fails at 1** | flux 0.4 < 0.85 |"));
  EXPECT_THAT(text, Not(HasSubstr("| S1 | LoRes |"))) << "does not apply";
}

TEST(StabilityMap, PictureWritesEachValueInItsCell) {
  const std::string svg = measure::to_svg(small_map());
  for (const char* words :
       {">2.00<", ">2 of 4<", ">4.00+<", ">fails<", ">-<", ">Ours<", ">S9<", "Largest frame step",
        "does not apply", "fails at its own numbers", "a machine, two cores"})
    EXPECT_THAT(svg, HasSubstr(words));
  const auto count = [&](const std::string& what) {
    std::size_t found = 0;
    for (auto at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(">fails<"), 3u);
  EXPECT_EQ(count(">-<"), 3u) << "S1 is not for LoRes";
}

TEST(StabilityMap, NamesTheEffectsOfTheWater) {
  auto map = small_map();
  const std::string bare = measure::to_svg(map);
  EXPECT_THAT(bare, Not(HasSubstr("effect")));
  map.effects = {"cohesion tension_n_m = 1000", "air_drag rate_per_s = 4"};
  const std::string svg = measure::to_svg(map);
  for (const auto& effect : map.effects) EXPECT_THAT(svg, HasSubstr("water with the effect " + effect));
  EXPECT_THAT(figures::to_csv(measure::to_table(map)),
              HasSubstr("cpu; effect cohesion tension_n_m = 1000; effect air_drag"));
  EXPECT_THAT(measure::to_markdown(map),
              HasSubstr("cpu; effect cohesion tension_n_m = 1000; effect air_drag"));
}

class StabilityE2e : public test::TableTest {};

TEST_F(StabilityE2e, MapsOneCaseQuickly) {
  const auto ended = table("stability --case S9 --method HiRes --quick --csv " + path("map.csv") +
                           " --markdown " + path("map.md") + " --svg " + path("map.svg"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto map = rows("map.csv");
  ASSERT_EQ(map.size(), 3u);
  for (const auto& row : map) {
    EXPECT_EQ(row.at("case"), "S9");
    EXPECT_EQ(row.at("method"), "HiRes");
    EXPECT_NE(row.at("status"), "default_fails") << row.at("failed_beyond");
    EXPECT_GE(std::stod(row.at("margin")), 1);
    EXPECT_THAT(row.at("circumstances"), HasSubstr(" logical processors; back end cpu"));
  }
  EXPECT_EQ(map[1].at("knob"), "iterations");
  EXPECT_THAT(ended.out, HasSubstr("| S9 | HiRes |"));
  EXPECT_THAT(base::read_file(path("map.md"), 1 << 16), HasSubstr("| S9 | HiRes |"));
  EXPECT_THAT(base::read_file(path("map.svg"), 1 << 20), HasSubstr("<svg"));
}

TEST_F(StabilityE2e, ACaseThatScalesNothingHasNoScale) {
  const auto ended = table("stability --case S12 --method HiRes --quick --csv " + path("map.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto map = rows("map.csv");
  ASSERT_EQ(map.size(), 2u);
  EXPECT_EQ(map[0].at("knob"), "frame_step");
  EXPECT_EQ(map[1].at("knob"), "iterations");
}

TEST_F(StabilityE2e, MapsACaseInWaterWithEffects) {
  NEEDS_EFFECTS;
  const auto ended =
      table("stability --case S9 --method LoRes --quick --effects data/scenes/splash.toml --csv " +
            path("map.csv"));
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto map = rows("map.csv");
  ASSERT_EQ(map.size(), 3u);
  for (const auto& row : map) {
    EXPECT_NE(row.at("status"), "default_fails") << row.at("failed_beyond");
    EXPECT_THAT(row.at("circumstances"), HasSubstr("effect air_drag rate_per_s = 4 coarsest_level = 3"));
  }
}

TEST_F(StabilityE2e, RefusesWhatIsNotThereAndSaysWhatIs) {
  const auto expect_refused = [&](const std::string& arguments, const std::string& told) {
    const auto ended = table("stability --quick " + arguments);
    EXPECT_NE(ended.exit_code, 0) << arguments;
    EXPECT_THAT(ended.out, HasSubstr(told)) << arguments;
  };
  expect_refused("--case S99", "S9");
  expect_refused("--case S99", "S2,");
  expect_refused("--method Water", "FovFluid");
  expect_refused("--resolution 1.5", "--quick");
  expect_refused("--effects data/scenes/single_dam.toml", "is a scene without effects");
  expect_refused("--case S9 --csv " + path("."), path("."));
  const auto coarse = table("stability --most 1.5 --resolution 2");
  EXPECT_THAT(coarse.out, HasSubstr("--resolution 2"));
  EXPECT_EQ(coarse.exit_code, 1);
  EXPECT_NE(table("stability --most nan").exit_code, 0);
}

}  // namespace
}  // namespace apps
