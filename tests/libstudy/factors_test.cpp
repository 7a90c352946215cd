/// Protocols of format 3: factors, their combinations, and how participants are dealt to groups.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/protocol/reference.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

using namespace study;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

const std::string hitches_text = base::read_file(VIP_TEST_DIR "/../protocols/hitches.toml", 1 << 20);
const std::string twin_text = base::read_file(VIP_TEST_DIR "/../protocols/trace_smoothed.toml", 1 << 20);

Protocol read(const std::string& text) { return parse_protocol(text, "own.toml"); }

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST(Factors, TheExampleOfTheReferenceIsAProtocol) {
  const Protocol protocol = read(protocol_example());
  EXPECT_EQ(cell_groups(protocol.design).size(), 2u);
  EXPECT_EQ(trials_of_group(protocol.design), 10);
}

TEST(Factors, CrossAndGroupByTheBetweenSubjectFactor) {
  const Protocol protocol = read(hitches_text);
  const Design& design = protocol.design;
  ASSERT_EQ(design.factors.size(), 2u);
  EXPECT_FALSE(design.factors[0].between);
  EXPECT_TRUE(design.factors[1].between);
  EXPECT_EQ(design.cells.size(), 12u);
  EXPECT_EQ(cell_groups(design).size(), 2u);
  EXPECT_EQ(trials_of_group(design), 60);
  EXPECT_EQ(cell_name(design, design.cells[8]), "hitch h50, content drop");
  EXPECT_EQ(design.cells[8].stimulus.scene, "data/scenes/droplet.toml");
  EXPECT_EQ(design.cells[8].setting.profile->hitch_ms, 50);
}

TEST(Factors, BetweenSubjectLevelsAreDealtEvenlyAndDropoutsAreReplaced) {
  const Protocol protocol = read(hitches_text);
  std::vector<int> taken;
  std::map<int, int> met;
  for (int person = 0; person < 20; ++person) {
    taken.push_back(next_slot(protocol, taken));
    const Plan plan = make_plan(protocol, "P" + std::to_string(person), 1, taken.back());
    std::set<int> groups;
    std::map<int, int> shown;
    for (const PlannedTrial& trial : plan.trials) {
      if (protocol.blocks[static_cast<std::size_t>(trial.block)].kind != BlockKind::Stimulus) continue;
      groups.insert(trial.first / 6);
      ++shown[trial.first];
    }
    ASSERT_EQ(groups.size(), 1u) << "a participant sees one content only";
    EXPECT_EQ(shown.size(), 6u);
    for (const auto& [cell, count] : shown) EXPECT_EQ(count, 10);
    ++met[*groups.begin()];
  }
  EXPECT_EQ(met[0], 10);
  EXPECT_EQ(met[1], 10);
  const int dropped = taken.back();
  taken.pop_back();
  EXPECT_EQ(next_slot(protocol, taken) % 2, dropped % 2);
}

TEST(Factors, RepetitionsOfACellHaveDifferentIntervals) {
  const Plan plan = make_plan(read(hitches_text), "P01", 1, 0);
  std::map<int, std::set<std::uint64_t>> seeds;
  for (const PlannedTrial& trial : plan.trials)
    if (trial.position >= 4) seeds[trial.first].insert(trial.schedule_seed);
  for (const auto& [cell, different] : seeds) EXPECT_EQ(different.size(), 10u);
}

TEST(Factors, EachTrialOfForcedChoiceHoldsTheStandard) {
  const Protocol protocol = read(twin_text);
  int first = 0, all = 0;
  for (int slot = 0; slot < 8; ++slot) {
    for (const PlannedTrial& trial : make_plan(protocol, "P01", 1, slot).trials) {
      ASSERT_TRUE(trial.second);
      EXPECT_NE(trial.first, *trial.second);
      EXPECT_TRUE(trial.first == 0 || *trial.second == 0);
      first += trial.first == 0;
      ++all;
    }
  }
  EXPECT_EQ(all, 8 * 4 * 8);
  EXPECT_EQ(first, all / 2) << "rounds come in couples of opposite orders";
}

TEST(Factors, CombinationsListTheCells) {
  const std::string text = changed(hitches_text, "[design]", R"([[combination]]
hitch = "none"
content = "drop"
[[combination]]
hitch = "h33"
content = "dam"
[[combination]]
hitch = "h50"
content = "drop"
[[combination]]
hitch = "h67"
content = "dam"
[[combination]]
hitch = "h100"
content = "drop"
[[combination]]
hitch = "h150"
content = "dam"

[design])");
  const Protocol protocol = read(text);
  std::vector<std::string> names;
  for (const Cell& cell : protocol.design.cells) names.push_back(level_name(protocol.design, cell, 0));
  EXPECT_THAT(names, ElementsAre("h33", "h67", "h150", "none", "h50", "h100")) << "grouped by content";
}

TEST(Factors, OrderMayKeepLevelsApart) {
  const Protocol protocol = read(
      changed(hitches_text, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"hitch\"]"));
  const Plan plan = make_plan(protocol, "P01", 1, 0);
  for (std::size_t i = 5; i < plan.trials.size(); ++i)
    EXPECT_NE(plan.trials[i].first, plan.trials[i - 1].first) << i;
}

TEST(Factors, RefuseWhatTheyDoNotUnderstand) {
  const struct {
    std::string from, to, words;
  } cases[] = {
      {"vary = \"within\"", "vary = \"mixed\"", "between"},
      {"name = \"h33\"", "name = \"none\"", "is a level of this factor already"},
      {"name = \"content\"", "name = \"hitch\"", "is the name of another factor"},
      {"scene = \"data/scenes/droplet.toml\"", "method = \"Ours\"", "sets other keys than the first level"},
      {"method = \"HiRes\"", "method = \"HiRez\"", "HiRes"},
      {"method = \"HiRes\"\n", "", "names no method, and no factor sets it"},
      {"n_star = \"8k\"", "n_star = \"many\"", "is no number of particles"},
      {"hitch_ms = 50", "hitch_ms = 5", "shorter than a frame"},
      {"profile = \"hitches\"", "profile = \"hitch\"", "hitches"},
      {"hitch_ms = 50", "hitch_ms = 50, low_fps = 3", "low_fps"},
      {"duration_s = 4", "duration_s = 4\ntiming = \"equal\"", "timing"},
      {"duration_s = 4", "duration_s = 4\nstandard = {hitch = \"none\"}", "needs pairs"},
      {"repetitions = 10", "repetitions = 200", "1200 trials"},
      {"mean_fps = 60", "mean_fps = 60, latency_ms = 20", "real_time"},
      {"[design]", "[[combination]]\nhitch = \"none\"\n\n[design]", "content"},
      {"[design]", "[[combination]]\nhitch = \"none\"\ncontent = \"sea\"\n\n[design]",
       "is no level of this factor"},
      {"[design]", "[[combination]]\nhitch = \"none\"\ncontent = \"dam\"\n\n[design]", "never has level"},
      {"order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"method\"]", "is no factor"},
  };
  for (const auto& one : cases) {
    std::string text = changed(hitches_text, one.from, one.to);
    if (one.words == "real_time") text = changed(text, "mode = \"real_time\"", "mode = \"per_frame\"");
    const std::string error = error_of(text);
    EXPECT_THAT(error, HasSubstr(one.words)) << one.to;
    EXPECT_THAT(error, HasSubstr("own.toml:")) << one.to;
    EXPECT_THAT(error, HasSubstr("mend: ")) << one.to;
  }
  EXPECT_THAT(error_of(changed(twin_text, "standard = {frames = \"even\"}", "standard = {frames = \"odd\"}")),
              HasSubstr("is no level of this factor"));
  EXPECT_THAT(error_of(changed(hitches_text, "format = 3", "format = 4")), HasSubstr("2 and 3"));
}

TEST(Factors, ShorterTrialsKeepTheProfile) {
  Protocol protocol = read(hitches_text);
  override_trial_seconds(protocol, 2);
  EXPECT_EQ(protocol.design.cells[2].setting.duration_s, 2);
  EXPECT_NEAR(protocol.design.cells[2].setting.mean, 118.0 / 2, 1e-9);
}
