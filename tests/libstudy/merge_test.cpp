#include "libstudy/store/merge/merge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "libstudy/store/personal.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/stored_content.hpp"
#include "tests/libstudy/study_fixture.hpp"
#include "tests/libstudy/version_1.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

using test::contents;
using test::everything;
using test::joined;
using test::Lines;
using test::select;

Lines codes(const fs::path& path) { return select(path, "SELECT participant FROM session ORDER BY 1"); }

void plan(const fs::path& path, const Protocol& protocol, const std::string& station,
          const Lines& participants, bool test_data = false) {
  RunPlan run = test::run_plan(protocol, participants);
  for (SessionPlan& session : run.sessions) {
    session.station = station;
    session.test_data = test_data;
  }
  Store(path, Open::Create).add_run(run);
}

/// Answers `count` trials of every open session, with a note for each.
void go_on(const fs::path& path, int count) {
  Store store(path, Open::Write);
  const auto runs = store.open_runs();
  for (const OpenRun& run : runs) {
    for (const OpenSession& session : run.sessions) {
      int left = count;
      for (const OpenUnit& unit : session.units) {
        if (!unit.trial || left-- <= 0) continue;
        const char* question = run.protocol_name == "pairs" ? "ease" : "satisfaction";
        test::answer_one(store, session, unit, question, test::score(1 + left % 7));
        store.note(session.id, unit.id, session.plan.station + " " + session.plan.participant);
      }
    }
  }
}

/// The files of three stations. They are made once; each test takes a copy.
class ThreeStations {
 public:
  ThreeStations() {
    const fs::path north = folder / "north.db", south = folder / "south.db", east = folder / "east.db";
    plan(north, test::pilot(), "north", {"P01", "P02"});
    go_on(north, 3);
    plan(south, test::pilot(), "south", {"P02", "P03"});
    plan(south, test::pairs(), "south", {"P02"});
    go_on(south, 2);
    plan(east, test::pairs(), "east", {"P02", "P04"});
    go_on(east, 1);
  }
  const test::TemporaryFolder folder;
};

class Stations : public ::testing::Test {
 protected:
  Stations() {
    static const ThreeStations made;
    for (const auto& entry : fs::directory_iterator(made.folder.path()))
      fs::copy(entry.path(), folder / entry.path().filename(), fs::copy_options::recursive);
  }
  fs::path path(const std::string& name) const { return folder / (name + ".db"); }

  test::TemporaryFolder folder;
};

TEST_F(Stations, TheUnionIsExact) {
  const std::vector<fs::path> sources{path("north"), path("south"), path("east")};
  std::vector<std::string> bytes;
  for (const fs::path& source : sources) bytes.push_back(test::bytes_of(source));
  const Merge done = merge(sources, path("all"));
  EXPECT_EQ(contents(path("all")), joined(sources));
  EXPECT_EQ(done.sessions, 7);
  EXPECT_EQ(done.recognised, 0);
  for (std::size_t i = 0; i < sources.size(); ++i) EXPECT_TRUE(test::bytes_of(sources[i]) == bytes[i]);
  for (const char* table :
       {"session", "framing", "unit", "trial", "presentation", "frame", "response", "note", "event", "run"}) {
    std::int64_t sum = 0;
    const std::string sql = std::string("SELECT count(*) FROM ") + table;
    for (const fs::path& source : sources) sum += std::stoll(select(source, sql)[0]);
    EXPECT_EQ(select(path("all"), sql)[0], std::to_string(sum)) << table;
    EXPECT_GT(sum, 0) << table;
  }
  EXPECT_EQ(select(path("all"), "SELECT count(*) FROM protocol")[0], "2");
  EXPECT_THAT(select(path("all"), "SELECT * FROM pragma_foreign_key_check"), IsEmpty());
  EXPECT_THAT(select(path("all"), "PRAGMA integrity_check"), ElementsAre("ok"));
}

TEST_F(Stations, AnyOrderAndAnyStepsGiveTheSame) {
  merge({path("north"), path("south"), path("east")}, path("all"));
  const Lines all = everything(path("all"));
  std::vector<std::string> order{"east", "north", "south"};
  do {
    const fs::path direct = folder / ("direct_" + order[0] + order[1] + ".db");
    merge({path(order[0]), path(order[1]), path(order[2])}, direct);
    EXPECT_EQ(everything(direct), all);
    const fs::path stepwise = folder / ("stepwise_" + order[0] + order[1] + ".db");
    merge({path(order[0]), path(order[1])}, stepwise);
    merge({path(order[2])}, stepwise);
    EXPECT_EQ(everything(stepwise), all);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_F(Stations, MergedAgainNothingChanges) {
  merge({path("north"), path("south")}, path("all"));
  const Lines all = everything(path("all"));
  const Merge again = merge({path("south"), path("north"), path("south"), path("all")}, path("all"));
  EXPECT_EQ(everything(path("all")), all);
  EXPECT_EQ(again.sessions, 5);
  EXPECT_EQ(again.recognised, 5);
}

TEST_F(Stations, OneCodeOfSeveralPeopleBecomesOneForEach) {
  const Merge done = merge({path("north"), path("south"), path("east")}, path("all"));
  EXPECT_THAT(codes(path("all")),
              ElementsAre("P01", "P02-east", "P02-north", "P02-south", "P02-south", "P03", "P04"));
  EXPECT_THAT(done.renamed,
              ElementsAre("P02 of station 'east' is P02-east", "P02 of station 'north' is P02-north",
                          "P02 of station 'south' is P02-south"));
}

TEST_F(Stations, CodesStayDistinctWhereStationsDoNotTellThemApart) {
  plan(path("twin"), test::pilot(), "north", {"P02"});
  plan(path("trap"), test::pilot(), "west", {"P02-south"});
  plan(path("none"), test::pilot(), "", {"P02"});
  plan(path("odd"), test::pilot(), "room 3/b", {"P02"});
  merge({path("north"), path("twin"), path("trap"), path("south"), path("none"), path("odd")}, path("all"));
  const Lines found = codes(path("all"));
  ASSERT_EQ(found.size(), 9u);
  EXPECT_EQ(std::count(found.begin(), found.end(), "P02-south"), 1);  // station "west" planned this code
  EXPECT_EQ(std::count(found.begin(), found.end(), "P02-room-3-b"), 1);
  EXPECT_EQ(std::count(found.begin(), found.end(), "P02-north"), 0);
  EXPECT_EQ(
      select(path("all"), "SELECT count(DISTINCT participant) = count(DISTINCT person) FROM session")[0],
      "1");
  for (const std::string& code : found) check_participant_code(code);
}

TEST_F(Stations, TheFurtherCopyOfASessionCounts) {
  fs::copy_file(path("north"), path("earlier"));
  go_on(path("north"), 4);
  const Lines further = contents(path("north"));
  merge({path("earlier"), path("north")}, path("all"));
  EXPECT_EQ(contents(path("all")), further);
  merge({path("north"), path("earlier")}, path("other"));
  EXPECT_EQ(everything(path("other")), everything(path("all")));
  merge({path("earlier")}, path("all"));
  EXPECT_EQ(contents(path("all")), further);
  merge({path("north")}, path("earlier"));
  EXPECT_EQ(contents(path("earlier")), further);
}

TEST_F(Stations, CopiesThatWentOnDifferentlyAreRefused) {
  fs::copy_file(path("north"), path("fork"));
  go_on(path("north"), 1);
  {
    Store store(path("fork"), Open::Write);
    store.note(store.open_runs().at(0).sessions.at(0).id, {}, "elsewhere");
  }
  merge({path("south")}, path("all"));
  const Lines before = everything(path("all"));
  for (const auto& sources :
       {std::vector{path("north"), path("fork")}, std::vector{path("fork"), path("north")}}) {
    EXPECT_THAT([&] { merge(sources, path("all")); },
                ThrowsMessage<base::Error>(HasSubstr("continued differently")));
    EXPECT_THROW(merge(sources, path("new")), base::Error);
  }
  EXPECT_EQ(everything(path("all")), before);
  EXPECT_FALSE(fs::exists(path("new")));
}

TEST_F(Stations, WithdrawnStaysWithdrawnWhateverIsMerged) {
  fs::copy_file(path("north"), path("old"));
  merge({path("north"), path("south")}, path("all"));
  withdraw(path("north"), "P02");
  const Merge done = merge({path("north"), path("old"), path("all")}, path("new"));
  EXPECT_THAT(done.withdrawn, ElementsAre("P02-north"));
  EXPECT_THAT(codes(path("new")), ElementsAre("P01", "P02-south", "P02-south", "P03"));
  merge({path("old")}, path("north"));
  EXPECT_THAT(codes(path("north")), ElementsAre("P01"));
  merge({path("north")}, path("old"));
  EXPECT_THAT(codes(path("old")), ElementsAre("P01"));
  EXPECT_THAT(select(path("old"), "SELECT participant FROM tombstone"), ElementsAre("P02"));
  const auto buried = merge({path("north")}, path("all")).buried;
  ASSERT_EQ(buried.size(), 1u);
  EXPECT_EQ(buried[0].first, "P02-north");
  EXPECT_EQ(buried[0].second.answers, 3);
  EXPECT_THAT(codes(path("all")), ElementsAre("P01", "P02-south", "P02-south", "P03"));
}

TEST_F(Stations, AWithdrawalReachesTheStationWithAllThatStandsBesideIt) {
  PersonalFile(path("north")).keep({{"P02", "age", "How old?", "zebra"}, {"P01", "age", "How old?", "31"}});
  {
    Connection now(path("north"), Open::Write);
    Statement(now, "VACUUM INTO ?").bind_all(path("north").string() + ".v2-old.bak").run();
  }
  merge({path("north"), path("south")}, path("all"));
  withdraw(path("all"), "P02-north");
  merge({path("all")}, path("north"));
  EXPECT_TRUE(PersonalFile(path("north")).read("P02").empty());
  EXPECT_EQ(PersonalFile(path("north")).read("P01").at(0).answer, "31");
  EXPECT_EQ(select(path("north").string() + ".v2-old.bak", "SELECT count(*) FROM session")[0], "1");
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    const std::string bytes = test::bytes_of(entry.path());
    EXPECT_EQ(bytes.find("zebra"), std::string::npos) << entry.path();
    if (entry.path().filename().string().starts_with("north")) {
      EXPECT_EQ(bytes.find("north P02"), std::string::npos) << entry.path();  // including the notes
    }
  }
}

TEST_F(Stations, PersonalDataFollowACodeThatChanges) {
  PersonalFile(path("north")).keep({{"P02", "age", "How old?", "30"}});
  merge({path("south")}, path("north"));
  EXPECT_EQ(PersonalFile(path("north")).read("P02-north").at(0).answer, "30");
  EXPECT_TRUE(PersonalFile(path("north")).read("P02").empty());
}

TEST_F(Stations, TestDataStayMarked) {
  plan(path("test"), test::pilot(), "west", {"T01"}, true);
  const Merge done = merge({path("test"), path("north")}, path("all"));
  EXPECT_EQ(done.sessions, 3);
  EXPECT_EQ(done.test_sessions, 1);
  EXPECT_THAT(select(path("all"), "SELECT participant FROM session WHERE test_data = 1"), ElementsAre("T01"));
  EXPECT_EQ(select(path("all"), "SELECT count(*) FROM protocol")[0], "1");
}

TEST_F(Stations, MergedSessionsAreResumedAndCountForTheBalance) {
  merge({path("north"), path("south"), path("east")}, path("all"));
  {
    Store store(path("all"), Open::Write);
    EXPECT_EQ(store.taken_slots(test::pilot().sha256).size(), 4u);
    std::size_t open = 0;
    for (const OpenRun& run : store.open_runs()) open += run.sessions.size();
    EXPECT_EQ(open, 7u);
  }
  go_on(path("all"), 30);
  const auto status = read_status(path("all"));
  EXPECT_TRUE(std::all_of(status.sessions.begin(), status.sessions.end(),
                          [](const SessionRow& session) { return session.answered == session.trials; }));
}

TEST_F(Stations, TextsUnderOneNameStayApartAndAreNamed) {
  const Protocol changed = parse_protocol(test::pilot().text + "\n", "changed.toml");
  plan(path("changed"), changed, "west", {"P09"});
  const Merge done = merge({path("north"), path("changed")}, path("all"));
  EXPECT_THAT(done.namesakes, ElementsAre("ptpe_pilot 2.0"));
  EXPECT_EQ(read_status(path("all")).protocols.size(), 2u);
}

TEST_F(Stations, AFailureLeavesNothing) {
  const auto files = [&] {
    return std::count_if(fs::directory_iterator(folder.path()), {},
                         [](const auto& entry) { return entry.path().extension() == ".db"; });
  };
  const auto before = files();
  EXPECT_THROW(merge({path("north"), path("missing")}, path("all")), base::Error);
  base::write_file_atomically(path("text"), std::string(5000, 'x'));
  EXPECT_THROW(merge({path("north")}, path("text")), base::Error);
  EXPECT_THROW(merge({path("text")}, path("north")), base::Error);
  const Store running(path("south"), Open::Write);
  EXPECT_THAT([&] { merge({path("north")}, path("south")); },
              ThrowsMessage<base::Error>(HasSubstr("another vip-study")));
  EXPECT_EQ(files(), before + 1);
}

TEST_F(Stations, ASecondSessionUnderOneVisitIsRefused) {
  fs::copy_file(path("east"), path("copy"));  // both record the next visit of P04
  plan(path("east"), test::pilot(), "east", {"P04"});
  plan(path("copy"), test::pilot(), "east", {"P04"});
  EXPECT_THAT(
      [&] {
        merge({path("east"), path("copy")}, path("all"));
      },
      ThrowsMessage<base::Error>(HasSubstr("a second time")));
}

TEST_F(Stations, RowsThatBelongToNothingAreNamed) {
  merge({path("south")}, path("all"));
  const Lines before = everything(path("all"));
  const auto refused = [&](const std::string& harm, const std::string& words) {
    fs::remove(path("broken"));
    fs::copy_file(path("north"), path("broken"));
    Connection(path("broken"), Open::Write).execute("PRAGMA foreign_keys = OFF;" + harm);
    EXPECT_THAT([&] { merge({path("broken")}, path("all")); },
                ThrowsMessage<base::Error>(
                    ::testing::AllOf(HasSubstr("broken.db"), HasSubstr(words), HasSubstr("salvage"))))
        << harm;
  };
  refused("DELETE FROM session WHERE session_id = 2", "refers to a missing row of session");
  refused("UPDATE frame SET presentation_id = 99 WHERE presentation_id = 3 AND frame_index = 0",
          "presentation_id 99 refers to a missing row of presentation");
  refused("UPDATE response SET question_id = 99 WHERE response_id = 2",
          "row 2 of response refers to a missing row of question");
  refused("UPDATE session SET run_id = 99", "refers to a missing row of run");
  refused(
      "UPDATE unit SET trial_id = (SELECT min(trial_id) FROM trial WHERE session_id = 2) WHERE unit_id = "
      "(SELECT min(unit_id) FROM unit WHERE session_id = 1 AND trial_id IS NOT NULL)",
      "which is not of its session");
  EXPECT_EQ(everything(path("all")), before);
}

TEST(MergeOfOldDatabases, Version1IsJoinedAndStaysAsItIs) {
  const test::TemporaryFolder folder;
  const fs::path old = folder / "old.db", now = folder / "now.db", all = folder / "all.db";
  test::write_version_1(old);
  const std::string before = test::bytes_of(old);
  plan(now, test::pilot(), "north", {"P02"});
  merge({old, now}, all);
  EXPECT_TRUE(test::bytes_of(old) == before);
  EXPECT_EQ(contents(all), joined({old, now}));
  EXPECT_EQ(select(all, "SELECT count(*) FROM protocol")[0], "2");
  withdraw(all, select(all, "SELECT participant FROM session WHERE station = '' AND code = 'P02'")[0]);
  merge({old}, all);
  EXPECT_THAT(select(all, "SELECT code || station FROM session ORDER BY 1"), ElementsAre("P01", "P02north"));
}

}  // namespace
}  // namespace study
