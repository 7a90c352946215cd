/// The key `surface` of protocols, and standards that name some of the factors.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/inference/power.hpp"
#include "tests/libstudy/study_fixture.hpp"

using namespace study;
using study::test::error_of_protocol;
using study::test::replaced;
using study::test::shipped_text;
using testing::AllOf;
using testing::HasSubstr;

namespace {

Protocol read(const std::string& text) { return parse_protocol(text, "own.toml"); }

}  // namespace

TEST(SurfaceKey, StandsInTheStimulusOrInTheLevelsOfAFactor) {
  const Protocol varied = read(shipped_text("surface"));
  ASSERT_EQ(varied.design.cells.size(), 12u);
  for (const Cell& cell : varied.design.cells) {
    EXPECT_EQ(cell.stimulus.surface, level_name(varied.design, cell, 0));
    EXPECT_EQ(treatment_name(cell.stimulus), cell.stimulus.method + ", " + cell.stimulus.surface);
  }
  const Protocol same =
      read(replaced(shipped_text("hitches"), "n_star =", "surface = \"spheres\"\nn_star ="));
  for (const Cell& cell : same.design.cells) EXPECT_EQ(cell.stimulus.surface, "spheres");
  for (const Cell& cell : read(shipped_text("hitches")).design.cells) EXPECT_EQ(cell.stimulus.surface, "");
}

TEST(SurfaceKey, IsRefusedWithPlaceAndMend) {
  const std::string text = shipped_text("surface");
  EXPECT_THAT(
      error_of_protocol(replaced(text, "surface = \"spheres\"\n\n[[factor.level]]",
                                 "surface = \"balls\"\n\n[[factor.level]]")),
      AllOf(HasSubstr("own.toml:"), HasSubstr("\"balls\""), HasSubstr("ellipsoids"), HasSubstr("mend: ")));
  EXPECT_THAT(error_of_protocol(replaced(text, "surface = \"ellipsoids\"\n", "")),
              HasSubstr("sets other keys than the first level"));
  EXPECT_THAT(
      error_of_protocol(replaced(text, "method = \"Ours\"", "method = \"Ours\"\nsurface = \"spheres\"")),
      HasSubstr("sets other keys than the first level"));
  // Format 2 has no such factor.
  EXPECT_THAT(
      error_of_protocol(replaced(shipped_text("task2"), "groups = 1", "groups = 1\nsurface = \"spheres\"")),
      HasSubstr("'design.surface' is not a known key"));
}

TEST(Standards, OfSomeFactorsHaveTheComparisonsLevelsOfTheOthers) {
  const Protocol protocol = read(shipped_text("surface"));
  const Design& design = protocol.design;
  const auto groups = cell_groups(design);
  ASSERT_EQ(groups.size(), 1u);
  const auto pairs = pairs_of_group(design, groups.front());
  ASSERT_EQ(pairs.size(), 6u);
  for (const auto& [cell, standard] : pairs) {
    const Cell &a = design.cells[static_cast<std::size_t>(cell)],
               &b = design.cells[static_cast<std::size_t>(standard)];
    EXPECT_EQ(a.stimulus.surface, "ellipsoids");
    EXPECT_EQ(b.stimulus.surface, "spheres");
    EXPECT_EQ(a.stimulus.method, b.stimulus.method);
    EXPECT_EQ(a.stimulus.scene, b.stimulus.scene);
  }
  std::map<std::pair<int, int>, int> shown;  // first and second stimulus, of all participants
  for (int slot = 0; slot < protocol.participants; ++slot) {
    std::map<std::pair<int, int>, int> of_person;
    for (const PlannedTrial& trial : make_plan(protocol, "P", 1, slot).trials) {
      if (protocol.blocks[static_cast<std::size_t>(trial.block)].kind != BlockKind::Stimulus) continue;
      ++shown[{trial.first, *trial.second}];
      ++of_person[std::minmax(trial.first, *trial.second)];
    }
    ASSERT_EQ(of_person.size(), 6u);
    for (const auto& [pair, times] : of_person) EXPECT_EQ(times, 4);
  }
  ASSERT_EQ(shown.size(), 12u);
  for (const auto& [order, times] : shown) EXPECT_EQ(times, 4 * protocol.participants / 2);
}

TEST(Standards, NeedAComparisonAndALevel) {
  const std::string text = shipped_text("surface"), standard = "standard = {surface = \"spheres\"}";
  EXPECT_THAT(error_of_protocol(replaced(text, standard, "standard = {}")), HasSubstr("names no level"));
  EXPECT_THAT(error_of_protocol(replaced(text, standard, "standard = {surfaces = \"spheres\"}")),
              HasSubstr("names no level"));
  EXPECT_THAT(
      error_of_protocol(replaced(text, standard, "standard = {surface = \"spheres\", metod = \"Ours\"}")),
      HasSubstr("metod"));
  const std::string three = R"([[combination]]
surface = "spheres"
method = "HiRes"
scene = "single_dam"
[[combination]]
surface = "ellipsoids"
method = "HiRes"
scene = "single_dam"
[[combination]]
surface = "ellipsoids"
method = "Ours"
scene = "faucet"
[[combination]]
surface = "spheres"
method = "HiRes"
scene = "jet_impact"

[design])";
  EXPECT_THAT(
      error_of_protocol(replaced(text, "[design]", three)),
      AllOf(HasSubstr("has no cell for the comparison with surface ellipsoids, method Ours, scene faucet"),
            HasSubstr("mend: ")));
  // The level of a procedure may not turn the standard.
  EXPECT_THAT(error_of_protocol(
                  replaced(replaced(shipped_text("hitch_quest"), "[design]",
                                    "[design]\npairs = true\nstandard = "
                                    "{look = \"old\"}"),
                           "[[factor]]",
                           "[[factor]]\nname = \"look\"\nvary = \"within\"\n[[factor.level]]\nname = "
                           "\"old\"\nsurface = \"spheres\"\n[[factor.level]]\nname = \"new\"\nsurface = "
                           "\"ellipsoids\"\n\n[[factor]]")),
              HasSubstr("has no level in standard"));
}

/// The head of protocols/surface.toml says how its number of participants was chosen.
TEST(SurfaceProtocol, HasTheParticipantsThatItsHeadCounts) {
  constexpr double relative_efficiency = 0.955;  // of the Wilcoxon test: 3 / pi for normal values
  int n = 2;
  while (*stats::t_power(n, 0.6, 0.025, stats::Design::OneSample, stats::Alternative::Greater) < 0.8) ++n;
  EXPECT_EQ(n, 24);
  const double wanted = std::ceil(n / relative_efficiency);
  EXPECT_EQ(wanted, 26);
  EXPECT_EQ(read(shipped_text("surface")).participants, 26);
}
