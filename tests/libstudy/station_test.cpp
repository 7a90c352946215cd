/// Stations that record one study: the shares of the assignment that they get, and the balance of the merged
/// study.
#include "libstudy/design/station.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/plan_fixture.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(StationNumber, IsReadFromTheEndOfTheName) {
  EXPECT_EQ(parse_station_number("2/5"), (StationNumber{2, 5}));
  EXPECT_EQ(parse_station_number("lab 2 2/5"), (StationNumber{2, 5}));
  for (const char* name : {"", "lab2", "lab2/5", "2/5 north", "2-5"})
    EXPECT_EQ(parse_station_number(name), std::nullopt) << name;
  for (const char* wrong : {"0/5", "6/5", "1/0", "lab 7/1000"})
    EXPECT_THROW(parse_station_number(wrong), base::Error) << wrong;
}

// Stations that each record the same number of people are together as balanced as one station with all of
// them.
TEST(StationNumber, SharesTogetherAreTheWholeAssignment) {
  for (const char* name : {"task1", "task2", "task1_lab", "ptpe_pilot"}) {
    const Protocol protocol = test::shipped(name);
    const int slots = slot_count(protocol);
    for (const int stations : {1, 2, 3, 5, 7}) {
      std::vector<int> uses(static_cast<std::size_t>(slots));
      std::vector<std::vector<int>> taken(static_cast<std::size_t>(stations));
      for (int person = 1; person <= 30; ++person) {
        for (int k = 0; k < stations; ++k) {
          auto& own = taken[static_cast<std::size_t>(k)];
          own.push_back(next_slot(protocol, own, StationNumber{k + 1, stations}));
          ++uses[static_cast<std::size_t>(own.back())];
        }
        const auto [least, most] = std::minmax_element(uses.begin(), uses.end());
        ASSERT_LE(*most - *least, 1) << name << ", station of " << stations << ", person " << person;
      }
    }
  }
}

TEST(StationNumber, AFreeSlotOfTheShareIsFilledFirst) {
  const Protocol protocol = test::shipped("task1");
  std::vector<int> taken{1, 3, 7, 9};
  EXPECT_EQ(next_slot(protocol, taken, StationNumber{2, 2}), 5);
  EXPECT_EQ(next_slot(protocol, taken, std::nullopt), 0);
}

TEST(StationNumber, ChangesTheSeedAndWithoutOneNothingChanges) {
  EXPECT_EQ(seed_of_station(7, std::nullopt), 7u);
  std::set<std::uint64_t> seeds{7};
  for (int k = 1; k <= 5; ++k) {
    seeds.insert(seed_of_station(7, StationNumber{k, 5}));
    EXPECT_EQ(seed_of_station(7, StationNumber{k, 5}), seed_of_station(7, StationNumber{k, 6}));
    EXPECT_LT(seed_of_station(7, StationNumber{k, 5}), 1ull << 63);
  }
  EXPECT_EQ(seeds.size(), 6u);
}

/// Plans six people of Task 1 as vip-study run does, with the codes P(100 + from) and following.
void record_six(const fs::path& path, const std::string& station, int from = 1) {
  const Protocol protocol = test::shipped("task1");
  const auto number = parse_station_number(station);
  Store store(path, Open::Create);
  std::vector<int> taken = store.taken_slots(protocol.sha256);
  RunPlan run{protocol, "{}", {}};
  for (int i = from; i < from + 6; ++i) {
    taken.push_back(next_slot(protocol, taken, number));
    const std::string code = "P" + std::to_string(100 + i);
    SessionPlan session = test::session_plan(protocol, code, seed_of_station(7, number), taken.back());
    session.station = station;
    session.station_number = number;
    run.sessions.push_back(session);
  }
  store.add_run(run);
}

std::vector<std::string> orders_of(const fs::path& path) {
  const auto database = open_database(path, Open::Read, read_schema_steps());
  Statement row(*database,
                "SELECT group_concat(t.first_cell, ' ') FROM (SELECT * FROM trial ORDER BY position) t JOIN "
                "session s USING (session_id) GROUP BY s.session_id ORDER BY s.participant");
  std::vector<std::string> out;
  while (row.step()) out.push_back(row.text(0));
  return out;
}

TEST(StationMerge, TwoStationsOfSixUseEachSequenceOnceAndOrderP01Differently) {
  const test::TemporaryFolder folder;
  record_six(folder / "a.db", "1/2");
  record_six(folder / "b.db", "2/2");
  const Merge done = merge({folder / "a.db", folder / "b.db"}, folder / "all.db");
  ASSERT_THAT(done.balance, SizeIs(1));
  EXPECT_EQ(done.balance[0].sequence_uses, std::vector<int>(12, 1));
  EXPECT_FALSE(done.balance[0].off());
  EXPECT_EQ(describe(done.balance[0]), "task1 1.0, 12 sessions: 12 sequences, each used once");
  EXPECT_THAT(done.station_troubles, IsEmpty());
  EXPECT_NE(orders_of(folder / "a.db")[0], orders_of(folder / "b.db")[0]);
  // An earlier copy of a station and the earlier result of the merge do not count as further stations.
  fs::copy_file(folder / "a.db", folder / "copy.db");
  record_six(folder / "a.db", "1/2", 7);
  const Merge again = merge({folder / "copy.db", folder / "a.db", folder / "b.db"}, folder / "all.db");
  EXPECT_THAT(again.station_troubles, IsEmpty());
}

TEST(StationMerge, WithoutNumbersItSaysThatTheBalanceIsOffAndWhy) {
  const test::TemporaryFolder folder;
  record_six(folder / "a.db", "north");
  record_six(folder / "b.db", "south");
  const Merge none = merge({folder / "a.db", folder / "b.db"}, folder / "none.db");
  EXPECT_TRUE(none.balance.at(0).off());
  EXPECT_THAT(describe(none.balance[0]), HasSubstr("12 sequences, 6 used twice, 6 never"));
  EXPECT_THAT(none.station_troubles, Contains(HasSubstr("without a station number")));

  record_six(folder / "c.db", "east 1/2");
  record_six(folder / "d.db", "west 1/2");
  const Merge same = merge({folder / "c.db", folder / "d.db"}, folder / "same.db");
  EXPECT_TRUE(same.balance.at(0).off());
  EXPECT_THAT(same.station_troubles, Contains(HasSubstr("both recorded as station 1/2")));

  record_six(folder / "e.db", "2/3");
  EXPECT_THAT(merge({folder / "c.db", folder / "e.db"}, folder / "counts.db").station_troubles,
              Contains(HasSubstr("stations 1/2 and 2/3")));
  EXPECT_THAT(merge({folder / "a.db", folder / "e.db"}, folder / "some.db").station_troubles,
              Contains(AllOf(HasSubstr("2/3"), HasSubstr("without a station number"))));
}

}  // namespace
}  // namespace study
