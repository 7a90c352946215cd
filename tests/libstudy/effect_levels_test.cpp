/// Effects as a factor of the design: levels, cells, plans and their rows in the database.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/store.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/plan_fixture.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Protocol foam_with(const std::string& effects, const std::string& sets) {
  return parse_protocol(test::foam_text(effects, sets), "p.toml");
}

TEST(EffectLevels, AreAFactorWithinTheGroupsLikeTheMethod) {
  const Protocol protocol = test::shipped("foam");
  ASSERT_EQ(protocol.design.cells.size(), 4u);
  std::vector<std::string> names;
  for (const Cell& cell : protocol.design.cells) names.push_back(treatment_name(cell.stimulus));
  EXPECT_THAT(names, ElementsAre("LoRes, none", "LoRes, foam", "HiRes, none", "HiRes, foam"));
  EXPECT_EQ(cell_groups(protocol.design).size(), 1u);
  EXPECT_EQ(trials_of_group(protocol.design), 6);
  ASSERT_EQ(protocol.design.effects.size(), 2u);
  EXPECT_EQ(protocol.design.effects[0].words, "no effects");
  EXPECT_EQ(protocol.design.effects[1].words, "keeps foam");
}

TEST(EffectLevels, OfAProtocolWithoutThemAreNone) {
  const Protocol protocol = test::shipped("task2");
  EXPECT_TRUE(protocol.design.effects.empty());
  for (const Cell& cell : protocol.design.cells) {
    EXPECT_EQ(cell.stimulus.effects, "");
    EXPECT_EQ(treatment_name(cell.stimulus), cell.stimulus.method);
  }
}

TEST(EffectLevels, SayWhatTheyHold) {
  const Protocol protocol = foam_with(
      "effects = [\"scene\", \"both\", \"few\"]",
      "[[design.effect_set]]\nname = \"few\"\n[[design.effect_set.effect]]\nkind = \"foam\"\nemission_per_s "
      "= 0.1\nlifetime_s = 2\n[[design.effect_set]]\nname = \"both\"\nkeep = [\"foam\"]\neffect = [{kind = "
      "\"air_drag\", rate_per_s = 2}]\n");
  std::vector<std::string> words;
  for (const EffectSet& set : protocol.design.effects) words.push_back(set.name + ": " + set.words);
  EXPECT_THAT(words,
              ElementsAre("scene: those of the scene's file", "both: keeps foam; air_drag rate_per_s = 2",
                          "few: foam emission_per_s = 0.1 lifetime_s = 2"));
}

TEST(EffectLevels, EveryPairIsPlannedOnceAndEachOrderEquallyOften) {
  const Protocol protocol = test::shipped("foam");
  std::map<std::pair<int, int>, int> shown;
  for (int slot = 0; slot < 4 * slot_count(protocol); ++slot) {
    std::set<std::pair<int, int>> pairs;
    for (const PlannedTrial& trial :
         test::design_trials(protocol, make_plan(protocol, "P", 1, slot % slot_count(protocol)))) {
      ++shown[{trial.first, *trial.second}];
      pairs.insert(std::minmax(trial.first, *trial.second));
    }
    EXPECT_EQ(pairs.size(), 6u);
  }
  ASSERT_EQ(shown.size(), 12u);
  for (const auto& [pair, times] : shown) EXPECT_EQ(times, 2 * slot_count(protocol));
}

TEST(EffectLevels, NeverAdjacentKeepsNeighboursApart) {
  const std::string text =
      test::replaced(test::with_keys(test::shipped_text("demo"),
                                     {{"never_adjacent", "[\"effects\"]\neffects = [\"none\", \"scene\"]"},
                                      {"method", "[\"LoRes\", \"HiRes\", \"FovFluid\", \"Ours\"]"}}),
                     "timing = \"settings\"\nmean_fps = [15, 30]\nsd_fps = [0, 5]",
                     "timing = \"equal\"\nmean_fps = [30]\nsd_fps = [5]");
  const Protocol protocol = parse_protocol(text, "p.toml");
  const auto trials = test::design_trials(protocol, make_plan(protocol, "P01", 3, 0));
  ASSERT_EQ(trials.size(), 8u);
  for (std::size_t i = 1; i < trials.size(); ++i) {
    EXPECT_NE(test::stimulus_of(protocol, trials[i].first).effects,
              test::stimulus_of(protocol, trials[i - 1].first).effects);
  }
}

std::string error_of(const std::string& text) {
  try {
    parse_protocol(text, "p.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

TEST(EffectLevels, OneLevelAloneIsRefused) {
  const std::string text = test::with_keys(test::shipped_text("foam"), {{"effects", "[\"foam\"]"}});
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("p.toml:15:11: "), HasSubstr("holds 1 level"),
                                    HasSubstr("mend: name two levels or more")));
}

TEST(EffectLevels, OfAPilotAreRefused) {
  const std::string text = test::with_keys(test::shipped_text("ptpe_pilot"),
                                           {{"timing", "\"settings\"\neffects = [\"none\", \"scene\"]"}});
  EXPECT_THAT(error_of(text),
              AllOf(HasSubstr("p.toml:"), HasSubstr("cannot vary under timing = \"settings\""),
                    HasSubstr("mend: use timing = \"equal\"")));
}

TEST(EffectLevels, StandInTheDatabaseAndItsTables) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  Store(path, sqlite::Open::Create).add_run(test::run_plan(test::shipped("foam"), {"P01"}));
  EXPECT_THAT(test::column(path, "SELECT method || ' ' || effects || ' ' || effect_set FROM cell"),
              ElementsAre("LoRes none no effects", "LoRes foam keeps foam", "HiRes none no effects",
                          "HiRes foam keeps foam"));
  const TaskStudy study = read_tasks(path);
  ASSERT_EQ(study.protocols.size(), 1u);
  EXPECT_THAT(study.protocols[0].methods,
              ElementsAre("LoRes, none", "LoRes, foam", "HiRes, none", "HiRes, foam"));
  EXPECT_EQ(study.protocols[0].treatments[3].effects, "foam");
  EXPECT_FALSE(study.protocols[0].pilot());
  export_csv(path, folder / "out");
  EXPECT_THAT(test::bytes_of(folder / "out/cells.csv"),
              HasSubstr(",HiRes,16k,30,0,8,foam,keeps foam,,,\r\n"));
  EXPECT_THAT(test::bytes_of(folder / "out/dictionary.csv"), HasSubstr("\ncells.csv,effects,TEXT,"));
  EXPECT_THAT(test::bytes_of(folder / "out/dictionary.csv"), HasSubstr("\nratings.csv,second_effects,TEXT,"));
}

TEST(EffectLevels, WithoutTheFactorTheDatabaseHoldsNone) {
  const test::TemporaryFolder folder;
  Store(folder / "study.db", sqlite::Open::Create).add_run(test::run_plan(test::shipped("task2"), {"P01"}));
  EXPECT_THAT(test::column(folder / "study.db", "SELECT coalesce(effects, effect_set) FROM cell"), Each("~"));
}

/// Cells that were stored before the schema had effects have none, neither after an upgrade nor after a
/// salvage.
TEST(EffectLevels, OfTheSchemaBeforeAreNone) {
  const test::TemporaryFolder folder;
  const fs::path old = folder / "old.db", upgraded = folder / "upgraded.db";
  for (const fs::path& copy : {old, upgraded})
    fs::copy_file(fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v5.db", copy);
  const std::string cells =
      "SELECT cell || ' ' || scene || ' ' || method || ' ' || n_star || ' ' || mean_fps FROM cell ORDER BY 1";
  const auto before = test::column(old, cells);
  ASSERT_EQ(before.size(), 2u);
  sqlite::Connection(old, sqlite::Open::Write).integer("PRAGMA wal_checkpoint(TRUNCATE)");
  EXPECT_EQ(read_tasks(old).protocols[0].methods.size(), 2u) << "the temporary copy that reading makes";
  open_database(upgraded, sqlite::Open::Write, read_schema_steps());
  std::string bytes = test::bytes_of(old);
  std::fill_n(bytes.begin(), 100, '\0');
  base::write_file_atomically(old, bytes);
  salvage(old, folder / "salvaged.db");
  for (const fs::path& now : {upgraded, folder / "salvaged.db"}) {
    EXPECT_EQ(test::column(now, cells), before) << now;
    EXPECT_THAT(test::column(now, "SELECT coalesce(effects, effect_set) FROM cell"), Each("~")) << now;
    EXPECT_EQ(read_status(now).sessions.size(), 3u) << now;
  }
}

}  // namespace
}  // namespace study
