/// Protocols of format 3: factors, their combinations, how participants are dealt to groups, and their data
/// in certificates, exports, merges and salvages.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "libstudy/console/certificate.hpp"
#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/protocol/reference.hpp"
#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/bids_rules.hpp"
#include "tests/common/psych_ds_rules.hpp"
#include "tests/common/tables.hpp"
#include "tests/libstudy/session_fixture.hpp"

using namespace study;
using study::test::error_of_protocol;
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

TEST(Factors, ABreakFollowsEverySoManyTrials) {
  const std::string every = "break_every = 20";
  const Protocol protocol = read(changed(hitches_text, every, "break_every = 25"));
  const Plan plan = make_plan(protocol, "p1", 5, 0);
  std::vector<int> before;  // trials before each break
  int trials = 0;
  for (const PlannedUnit& unit : plan.units) {
    if (protocol.blocks[static_cast<std::size_t>(unit.block)].kind != BlockKind::Stimulus) continue;
    if (!unit.trial) before.push_back(trials);
    trials += unit.trial.has_value();
  }
  EXPECT_THAT(before, ElementsAre(25, 50)) << "of 60 trials";
  EXPECT_THAT(error_of_protocol(changed(hitches_text, every, "")), HasSubstr("add break_every"));
  EXPECT_THAT(error_of_protocol(changed(hitches_text, every, "break_every = 60")),
              HasSubstr("makes no break: a participant has 60 trials"));
}

TEST(Factors, OrderMayKeepLevelsApart) {
  const Protocol protocol = read(
      changed(hitches_text, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"hitch\"]"));
  const Plan plan = make_plan(protocol, "P01", 1, 0);
  for (std::size_t i = 5; i < plan.trials.size(); ++i)
    EXPECT_NE(plan.trials[i].first, plan.trials[i - 1].first) << i;
  // Four of seven cells have the content dam. An order in which no two adjacent trials have the same content
  // exists for one trial of each cell (4 of 7 have dam), but not for ten (40 of 70).
  std::string cells;
  for (const char* cell :
       {"none dam", "h33 dam", "h50 dam", "h67 dam", "h100 drop", "h150 drop", "none drop"}) {
    const std::string words = cell;
    const std::size_t space = words.find(' ');
    cells += "[[combination]]\nhitch = \"" + words.substr(0, space) + "\"\ncontent = \"" +
             words.substr(space + 1) + "\"\n\n";
  }
  const std::string apart =
      changed(changed(changed(hitches_text, "vary = \"between\"", "vary = \"within\""), "[design]",
                      cells + "[design]"),
              "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"content\"]");
  EXPECT_THAT(error_of_protocol(apart), HasSubstr("40 of 70 trials have dam"));
  const std::string once = changed(apart, "repetitions = 10", "repetitions = 1");
  make_plan(read(changed(once, "break_every = 20", "break_every = 5")), "P01", 1, 0);
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
      {"hitch_ms = 50", "hitch_ms = 5", "is shorter than the"},
      {"duration_s = 4", "duration_s = 0.5", "no hitch may be shown"},
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
    const std::string error = error_of_protocol(text);
    EXPECT_THAT(error, HasSubstr(one.words)) << one.to;
    EXPECT_THAT(error, HasSubstr("own.toml:")) << one.to;
    EXPECT_THAT(error, HasSubstr("mend: ")) << one.to;
  }
  EXPECT_THAT(error_of_protocol(
                  changed(twin_text, "standard = {frames = \"even\"}", "standard = {frames = \"odd\"}")),
              HasSubstr("is no level of this factor"));
  EXPECT_THAT(error_of_protocol(changed(hitches_text, "format = 3", "format = 4")), HasSubstr("2 and 3"));
}

TEST(Factors, ShorterTrialsKeepTheProfile) {
  Protocol protocol = read(hitches_text);
  override_trial_seconds(protocol, 2);
  EXPECT_EQ(protocol.design.cells[2].setting.duration_s, 2);
  EXPECT_NEAR(protocol.design.cells[2].setting.mean, 118.0 / 2, 1e-9);
}

namespace {

namespace fs = std::filesystem;

/// The hitches protocol with one trial for each cell, and with other names of factors.
std::string small_text(const std::string& hitch, const std::string& content) {
  std::string text = changed(hitches_text, "repetitions = 10", "repetitions = 1");
  text = changed(text, "break_every = 20", "break_every = 4");
  text = changed(text, "name = \"hitch\"", "name = \"" + hitch + "\"");
  return changed(text, "name = \"content\"", "name = \"" + content + "\"");
}

/// Plays the sessions of two participants, who answer every trial, into a database. Both are in the
/// between-subject group of slot 0.
fs::path played(const fs::path& path, const std::string& text, const std::string& station = "north") {
  const Protocol protocol = read(text);
  Store store(path, sqlite::Open::Create);
  RunPlan plan = study::test::run_plan(protocol, {"P01", "P02"});
  for (SessionPlan& session : plan.sessions) session.station = station;
  store.add_run(plan);
  study::test::Desk desk(protocol);
  study::test::Scripted person;
  for (const OpenRun& run : store.open_runs())
    for (const OpenSession& session : run.sessions)
      run_session(protocol, session, desk.parts(person, store), {});
  return path;
}

std::string first_line(const fs::path& path) {
  const std::string text = base::read_file(path, 1 << 24);
  return text.substr(0, text.find_first_of("\r\n"));
}

}  // namespace

TEST(FactorData, TheCertificateHasARowForEachCellWithWhatWasAskedAndShown) {
  const study::test::TemporaryFolder folder;
  const fs::path path = played(folder / "study.db", small_text("hitch", "content"));
  const auto rows = read_certificate(path, 1, FpsMean::Harmonic);
  ASSERT_EQ(rows.size(), 6u);
  const CertificateRow& row = rows[2];
  const std::string content = row.levels.at(1).second;  // the content of the group of slot 0
  EXPECT_THAT(row.levels, ElementsAre(testing::Pair("hitch", "h50"),
                                      testing::Pair("content", testing::AnyOf("dam", "drop"))));
  EXPECT_EQ(row.timing, "60 frames/s, a hitch of 50 ms every 2 s, jitter 0.5");
  EXPECT_NEAR(row.longest_ms, 50, 1e-3);
  EXPECT_NEAR(row.p99_ms, 1000.0 / 60, 1e-3);
  EXPECT_EQ(row.hitches, 2);
  EXPECT_TRUE(row.animation_error_ms);
  const std::string text = format_certificate(rows, FpsMean::Harmonic, false);
  EXPECT_THAT(text, HasSubstr("\nhitch  content  asked "));
  EXPECT_THAT(text, HasSubstr("p99 ms  longest  hitches anim err"));
  EXPECT_THAT(text,
              testing::ContainsRegex("\nh50    d[amrop]+ +60 frames/s, a hitch of 50 ms.* 50.000     2.00 "));
  const auto of_protocol = read_certificate_of_protocol(path, 1, FpsMean::Harmonic);
  EXPECT_EQ(format_certificate(of_protocol, FpsMean::Harmonic, false), text);
  const StudyStatus status = read_status(path);
  const auto& cells = status.protocols.at(0).cells;
  ASSERT_EQ(cells.size(), 12u);
  for (const CellCount& cell : cells) {
    EXPECT_EQ(cell.trials, cell.levels.at(1).second == content ? 2 : 0) << "practice does not count";
    EXPECT_EQ(cell.answered, cell.trials);
  }
}

TEST(FactorData, ExportsHaveAColumnForEachFactorAndTheMomentsOfProfiles) {
  const study::test::TemporaryFolder folder;
  // Names of factors that could break an export: "frames" is also the name of a column, and "select" is a
  // keyword of SQL.
  const fs::path path = played(folder / "study.db", small_text("frames", "select"));
  export_csv(path, folder / "csv");
  const auto rows = ::test::read_csv(folder / "csv/ratings.csv");
  ASSERT_EQ(rows.size(), 2u * (6 + 4));
  for (const auto& row : rows) {
    EXPECT_THAT(row.at("first_select"), testing::AnyOf("dam", "drop"));
    EXPECT_EQ(row.at("second_select"), "");
    const bool steady = row.at("first_frames_level") == "none";
    EXPECT_EQ(row.at("first_timing") == "mean 60, SD 0 frames/s", steady);
    EXPECT_EQ(row.at("first_hitches"), steady ? "0" : "2");
    EXPECT_NEAR(std::stod(row.at("first_p99_ms")), 1000.0 / 60, 1e-3);
    EXPECT_LT(std::stod(row.at("first_animation_error_ms")), 0.1);
    EXPECT_NEAR(std::stod(row.at("first_frames")), 232, 8) << "the number of frames shown";
  }
  int described = 0;
  for (const auto& line : ::test::read_csv(folder / "csv/dictionary.csv")) {
    if (line.at("file") != "ratings.csv") continue;
    EXPECT_FALSE(line.at("meaning").empty()) << line.at("column");
    described += line.at("column") == "first_frames_level" || line.at("column") == "second_timing";
  }
  EXPECT_EQ(described, 2);

  export_bids(path, folder / "bids");
  EXPECT_THAT(::test::BidsRules::broken_by(folder / "bids"), testing::IsEmpty());
  const fs::path stem = folder / "bids/sub-P01/ses-hitchesv1/beh/sub-P01_ses-hitchesv1_task-hitches_events";
  for (const auto& row : ::test::read_tsv(stem.string() + ".tsv")) {
    EXPECT_EQ(row.at("select"), rows[0].at("first_select"));
    EXPECT_EQ(row.at("hitches"), row.at("frames_level") == "none" ? "0" : "2");
    EXPECT_THAT(row.at("timing"), HasSubstr(" frames/s"));
    EXPECT_NEAR(std::stod(row.at("p99_ms")), 1000.0 / 60, 1e-3);
  }
  const auto json = ::test::json_at(stem.string() + ".json");
  for (const char* name : {"select", "frames_level", "timing", "p99_ms", "hitches", "animation_error_ms"})
    EXPECT_TRUE(json.at(name).contains("Description")) << name;

  export_psych_ds(path, folder / "psych");
  EXPECT_THAT(::test::psych_ds_broken_by(folder / "psych"), testing::IsEmpty());
  EXPECT_THAT(base::read_file(folder / "psych/dataset_description.json", 1 << 24),
              HasSubstr("level of the factor frames"));
}

TEST(FactorData, ExportsWithoutFactorsKeepTheirColumns) {
  const study::test::TemporaryFolder folder;
  {
    Store store(folder / "study.db", sqlite::Open::Create);
    store.add_run(study::test::run_plan(study::test::pilot(), {"P01"}));
  }
  export_csv(folder / "study.db", folder / "csv");
  EXPECT_THAT(first_line(folder / "csv/ratings.csv"), testing::EndsWith(",second_tau_fps"));
  EXPECT_TRUE(read_status(folder / "study.db").protocols.at(0).cells.empty());
}

TEST(FactorData, FactorNamesOfAForeignDatabaseBecomeSafeNames) {
  const study::test::TemporaryFolder folder;
  const fs::path path = played(folder / "study.db", small_text("hitch", "content"));
  sqlite::Connection(path, sqlite::Open::Write)
      .execute(
          "UPDATE cell SET levels = 'it''s, \"x\") FROM cell --' || char(9) || ' = =1+1' || char(10) || "
          "'its_xFROMcell = b'");
  export_csv(path, folder / "csv");
  const auto rows = ::test::read_csv(folder / "csv/ratings.csv");
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows[0].at("first_itsxFROMcell"), "'=1+1") << "guarded against spreadsheets";
  EXPECT_EQ(rows[0].at("first_its_xFROMcell"), "b");
  export_bids(path, folder / "bids");
  EXPECT_THAT(::test::BidsRules::broken_by(folder / "bids"), testing::IsEmpty());
}

TEST(FactorData, SurvivesAMergeAndASalvage) {
  const study::test::TemporaryFolder folder;
  const fs::path south = played(folder / "south.db", small_text("hitch", "content"), "south");
  const fs::path north = played(folder / "north.db", small_text("hitch", "content"), "north");
  merge({south, north}, folder / "all.db");
  salvage(folder / "all.db", folder / "new.db");
  for (const char* name : {"all.db", "new.db"}) {
    const auto rows = read_certificate_of_protocol(folder / name, 1, FpsMean::Harmonic);
    ASSERT_EQ(rows.size(), 6u) << name;
    EXPECT_EQ(rows[4].levels.at(0).second, "h100") << name;
    EXPECT_EQ(rows[4].hitches, 2) << name;
    EXPECT_NEAR(rows[4].longest_ms, 100, 1e-3) << name;
    std::int64_t answered = 0;
    for (const CellCount& cell : read_status(folder / name).protocols.at(0).cells) answered += cell.answered;
    EXPECT_EQ(answered, 4 * 6) << name;
  }
}
