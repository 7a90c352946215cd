/// What push() and pull bring to the centre and back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/utc.hpp"
#include "tests/libstudy/central_fixture.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// Answers `count` trials of every open session.
void go_on_with(const fs::path& path, int count) {
  Store store(path, Open::Write);
  for (const OpenRun& run : store.open_runs()) {
    for (const OpenSession& session : run.sessions) {
      int left = count;
      for (const OpenUnit& unit : session.units)
        if (unit.trial && left-- > 0) test::answer_one(store, session, unit, "satisfaction", test::score(4));
    }
  }
}

class CentralPush : public ::testing::Test {
 protected:
  fs::path pilot_of(const std::string& name, const std::vector<std::string>& people) {
    const fs::path path = folder_ / name;
    Store(path, Open::Create).add_run(test::run_plan(test::pilot(), people));
    return path;
  }
  /// A new station of the lab.
  std::string station() { return lab_.admit("s" + std::to_string(++stations)); }

  static int stations;
  test::TemporaryFolder folder_;
  test::Lab& lab_ = test::lab();
};
int CentralPush::stations = 0;

TEST_F(CentralPush, EveryRowArrivesOnceAndARepeatedPushSendsNothing) {
  const fs::path file = pilot_of("s.db", {"P01", "P02"});
  const std::string north = station();
  go_on_with(file, 2);
  const Push first = push(file, north);
  EXPECT_EQ(first.sessions, 2);
  EXPECT_EQ(first.sent, 2);
  EXPECT_EQ(lab_.rows_of(north), test::Lab::rows_of_file(file));
  EXPECT_EQ(lab_.ask("SELECT count(*) FROM vip.frame WHERE sender = '" + north + "'"),
            test::column(file, "SELECT count(*) FROM frame"));
  const Push again = push(file, north);
  EXPECT_EQ(again.sent, 0);
  EXPECT_EQ(again.rows, 0);
  go_on_with(file, 3);
  const Push later = push(file, north);
  EXPECT_EQ(later.sent, 2);
  EXPECT_LT(later.rows, first.rows + 240) << "frames were sent a second time";
  EXPECT_EQ(lab_.rows_of(north), test::Lab::rows_of_file(file));
}

TEST_F(CentralPush, AnOlderCopyChangesNothing) {
  const fs::path file = pilot_of("s.db", {"P01"}), old = folder_ / "old.db";
  const std::string north = station();
  go_on_with(file, 1);
  fs::copy_file(file, old);
  go_on_with(file, 1);
  push(file, north);
  const auto rows = lab_.rows_of(north);
  const Push done = push(old, north);
  EXPECT_EQ(done.older, 1);
  EXPECT_EQ(done.rows, 0);
  EXPECT_EQ(lab_.rows_of(north), rows);
}

TEST_F(CentralPush, AMergeIntoTheFileSendsNoFrameAgain) {
  const fs::path file = pilot_of("s.db", {"P01", "P02"}), other = [&] {
    const base::FixedUtc earlier("2026-01-01T00:00:00Z");  // the merge puts these sessions first
    return pilot_of("other.db", {"P07", "P08"});
  }();
  const std::string north = station();
  for (const fs::path& path : {other, file}) go_on_with(path, 2);
  const std::string numbers =
      "SELECT min(presentation_id) || ' ' || person FROM presentation JOIN trial USING (trial_id) JOIN "
      "session USING (session_id) GROUP BY person";
  const auto before = test::column(file, numbers);
  push(file, north);
  merge({other}, file);
  auto after = test::column(file, numbers);
  std::sort(after.begin(), after.end());
  EXPECT_FALSE(std::includes(after.begin(), after.end(), before.begin(), before.end()))
      << "the merge kept all row numbers";
  const Push done = push(file, north);
  EXPECT_EQ(done.sent, 2) << "sessions that were there already were sent again";
  EXPECT_EQ(lab_.rows_of(north), test::Lab::rows_of_file(file));
  EXPECT_EQ(push(file, north).rows, 0);
}

TEST_F(CentralPush, ACopyThatWentAnotherWayIsRefusedAndTheOthersAreSent) {
  const fs::path file = pilot_of("s.db", {"P01"}), other = folder_ / "other.db";
  const std::string north = station();
  fs::copy_file(file, other);
  go_on_with(file, 1);
  push(file, north);
  const auto rows = lab_.rows_of(north);
  {
    Store store(other, Open::Write);
    const auto session = store.open_runs().at(0).sessions.at(0);
    store.note(session.id, {}, "another way");
    for (const OpenUnit& unit : session.units) {
      if (!unit.trial) continue;
      test::answer_one(store, session, unit, "satisfaction", test::score(2));
      break;
    }
    store.add_run(test::run_plan(test::pilot(), {"P02"}));
  }
  const Push done = push(other, north);
  ASSERT_EQ(done.refused.size(), 1u);
  EXPECT_THAT(done.refused[0], HasSubstr("participant P01, visit 1"));
  EXPECT_THAT(done.refused[0], HasSubstr("continued differently"));
  EXPECT_EQ(done.sent, 1);
  auto there = lab_.rows_of(north);
  EXPECT_TRUE(std::includes(there.begin(), there.end(), rows.begin(), rows.end()));
}

TEST_F(CentralPush, ARefusalInAnyCopyStays) {
  const fs::path file = test::gaze_of_two(folder_), copy = folder_ / "copy.db";
  const std::string north = station();
  const auto gaze = [&] { return lab_.ask("SELECT count(*) FROM vip.gaze WHERE sender = '" + north + "'"); };
  const auto shown = [&] { return lab_.ask("SELECT count(*) FROM lab.gaze WHERE sender = '" + north + "'"); };
  fs::copy_file(file, copy);
  push(file, north);
  EXPECT_THAT(gaze(), ElementsAre("3"));
  EXPECT_THAT(shown(), ElementsAre("3"));
  change_permissions(copy, "P01", {.gaze = false, .sharing = false});
  push(copy, north);
  EXPECT_THAT(gaze(), ElementsAre("1"));
  push(file, north);  // a copy that knows nothing of it
  EXPECT_THAT(gaze(), ElementsAre("1"));
  EXPECT_THAT(shown(), ElementsAre("1"));
  EXPECT_THAT(lab_.ask("SELECT count(*) FROM vip.permission_change WHERE sender = '" + north + "'"),
              ElementsAre("4"));
  EXPECT_THAT(lab_.ask("SELECT participant FROM shared.session WHERE sender = '" + north + "'"),
              ElementsAre("P02"));
  EXPECT_EQ(push(file, north).rows, 0);
  // An older copy brings a refusal too.
  fs::copy_file(file, folder_ / "third.db");
  change_permissions(folder_ / "third.db", "P02", {.gaze = false, .sharing = {}});
  {
    Store store(file, Open::Write);
    store.note(store.open_runs().at(0).sessions.at(1).id, {}, "goes on");
    const auto session = store.open_runs().at(0).sessions.at(1);
    test::answer_one(store, session, session.units.at(0), "rating", test::score(3));
  }
  push(file, north);
  EXPECT_EQ(push(folder_ / "third.db", north).older, 1);
  EXPECT_THAT(gaze(), ElementsAre("0"));
  EXPECT_THAT(shown(), ElementsAre("0"));
}

TEST_F(CentralPush, AWithdrawalWinsEverywhereAndComesBackByPull) {
  const fs::path north_file = pilot_of("n.db", {"P01", "P02"}), south_file = folder_ / "s.db",
                 old = folder_ / "old.db";
  go_on_with(north_file, 1);
  fs::copy_file(north_file, south_file);
  fs::copy_file(north_file, old);
  const std::string north = station(), south = station();
  push(north_file, north);
  push(south_file, south);
  const std::string person =
      test::column(north_file, "SELECT person FROM session WHERE participant = 'P01'").at(0);
  const std::string uid = test::column(north_file, "SELECT uid FROM session WHERE participant = 'P01'").at(0);
  withdraw(south_file, "P01");
  EXPECT_EQ(push(south_file, south).tombstones, 1);
  for (const central::Table& table : central::tables()) {
    const auto left = lab_.ask("SELECT t::text FROM vip." + pg::quoted_name(table.name) +
                               " t WHERE t::text LIKE '%" + person + "%' OR t::text LIKE '%" + uid + "%'");
    EXPECT_EQ(left.size(), table.name == "tombstone" ? 1u : 0u) << table.name;
  }
  EXPECT_THAT(lab_.ask("SELECT count(*) FROM vip.part WHERE of = '" + uid + "'"), ElementsAre("0"));
  for (const fs::path& file : {north_file, old}) {
    const Push done = push(file, north);
    EXPECT_EQ(done.withdrawn, 1);
    EXPECT_EQ(done.sent, 0);
    EXPECT_THAT(done.refused, IsEmpty());
  }
  EXPECT_THAT(lab_.ask("SELECT sender FROM vip.session WHERE person = '" + person + "'"), IsEmpty());
  EXPECT_THAT(withdrawn_at_centre(north_file, north), ElementsAre("P01"));
  withdraw(north_file, "P01");
  EXPECT_THAT(withdrawn_at_centre(north_file, north), IsEmpty());
  push(north_file, north);
  EXPECT_EQ(lab_.rows_of(north), test::Lab::rows_of_file(north_file));
}

TEST_F(CentralPush, ReadersSeeWhatTheyMay) {
  const fs::path file = folder_ / "s.db";
  {
    Store store(file, Open::Create);
    test::add_people(store, test::asking_protocol(),
                     {{"yes", 1, 1}, {"no", 1, 0}, {"silent", 1, {}}, {"later", 0, 1}});
    store.note(store.open_runs().at(0).sessions.at(0).id, {}, "zebra");
  }
  const std::string north = station();
  push(file, north);
  static const std::string reader = lab_.admit("reader", central::Admission::LabReader);
  static const std::string sharer = lab_.admit("sharer", central::Admission::SharedReader);
  const auto people = [&](const std::string& as, const std::string& schema) {
    return test::Lab::ask_as(as,
                             "SELECT participant FROM " + schema + ".session WHERE sender = '" + north + "'");
  };
  EXPECT_THAT(people(reader, "lab"), UnorderedElementsAre("yes", "no", "silent", "later"));
  const auto sharing = test::column(
      file, "SELECT participant FROM session JOIN sharing h USING (person) WHERE h.granted IS NOT 0");
  EXPECT_THAT(people(sharer, "shared"), ::testing::UnorderedElementsAreArray(sharing));
  EXPECT_THAT(test::Lab::ask_as(reader, "SELECT words FROM lab.note WHERE sender = '" + north + "'"),
              ElementsAre("zebra"));
  EXPECT_THAT(test::Lab::ask_as(sharer, "SELECT words FROM shared.note"), IsEmpty());
  EXPECT_THAT(test::message_of([&] { people(reader, "shared"); }), HasSubstr("permission denied"));
  EXPECT_THAT(test::message_of([&] { people(sharer, "lab"); }), HasSubstr("permission denied"));
  EXPECT_THAT(test::message_of([&] { people(sharer, "vip"); }), HasSubstr("permission denied"));
  EXPECT_THAT(test::message_of([&] { push(file, reader); }), HasSubstr("permission denied"));
  for (const central::Table& table : central::tables())
    test::Lab::ask_as(sharer, "SELECT 1 FROM shared." + pg::quoted_name(table.name) + " LIMIT 1");
}

TEST_F(CentralPush, HostileFilesAreRefusedWhole) {
  const std::string north = station();
  const auto spoiled = [&](const std::string& name, const std::string& sql) {
    const fs::path file = pilot_of(name, {"P01", "P02"});
    go_on_with(file, 1);
    sqlite::Connection(file, Open::Write).execute("PRAGMA foreign_keys = OFF; " + sql);
    fs::remove(file.string() + ".answers.jsonl");
    return file;
  };
  const std::string first = "(SELECT min(session_id) FROM session)";
  for (const auto& [sql, reason] : std::vector<std::pair<std::string, std::string>>{
           {"UPDATE session SET machine = CAST(x'610062' AS TEXT) WHERE session_id = " + first, "NUL byte"},
           {"UPDATE session SET machine = CAST(x'61ff62' AS TEXT) WHERE session_id = " + first,
            "invalid byte sequence"},
           {"UPDATE unit SET trial_id = 99 WHERE unit_id = (SELECT min(unit_id) FROM unit WHERE trial_id IS "
            "NOT NULL)",
            "foreign key"}}) {
    const fs::path file = spoiled(reason.substr(0, 3) + ".db", sql);
    const std::string uid = test::column(file, "SELECT uid FROM session WHERE session_id = " + first).at(0);
    const Push done = push(file, north);
    ASSERT_EQ(done.refused.size(), 1u) << reason;
    EXPECT_THAT(done.refused[0], HasSubstr(reason));
    EXPECT_EQ(done.sent, 1) << "the sound session was not sent";
    for (const char* table : {"session", "unit", "trial", "frame", "event"})
      EXPECT_THAT(lab_.ask(std::string("SELECT 1 FROM vip.") + table + " WHERE session_uid = '" + uid + "'"),
                  IsEmpty());
  }
}

}  // namespace
}  // namespace study
