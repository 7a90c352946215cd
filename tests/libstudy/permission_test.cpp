/// The meaning of the answers to gaze_kept and data_shared in databases of all versions, and later changes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "libstudy/store/permissions.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Permission, IsWhatWasAnswered) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    test::add_people(store, test::asking_protocol(), {{"P01", 1, 0}, {"P02", 0, 1}, {"P03", {}, {}}});
    test::add_people(store, test::asking_protocol(false, false), {{"P04", {}, {}}});
  }
  EXPECT_THAT(test::permissions_of(path),
              ElementsAre("P01 gaze 1", "P01 sharing 0", "P02 gaze 0", "P02 sharing 1", "P03 gaze 0",
                          "P03 sharing 0", "P04 gaze ~", "P04 sharing ~"));
}

TEST(Permission, OneRefusalOfAPersonCountsForAllSessions) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    test::add_people(store, test::asking_protocol(), {{"P01", 1, 1}, {"P02", 1, 1}});
    test::add_people(store, test::asking_protocol(), {{"P01", 1, 0}}, 2);
    test::add_people(store, test::asking_protocol(false, false), {{"P02", {}, {}}, {"P03", {}, {}}});
  }
  EXPECT_THAT(test::column(path,
                           "SELECT DISTINCT participant || ' ' || coalesce(granted, '~') FROM sharing "
                           "JOIN session USING (person) ORDER BY 1"),
              ElementsAre("P01 0", "P02 1", "P03 ~"));
}

/// The expected answers are those that fixtures/README lists.
TEST(Permission, OfAnEarlierSchemaFollowsItsAnswers) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  fs::copy_file(fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v2.db", path);
  const std::string granted =
      "SELECT participant FROM permission JOIN session USING (session_id) WHERE granted = ";
  const auto expect_answers = [&] {
    EXPECT_THAT(test::column(path, granted + "0 AND what = 'gaze' ORDER BY participant"),
                ElementsAre("P05", "P06", "P07"));
    EXPECT_THAT(test::column(path, granted + "1 AND what = 'gaze' ORDER BY participant"),
                ElementsAre("P01", "P02", "P03", "P04", "P08", "P09"));
    EXPECT_THAT(test::column(path, granted + "1 AND what = 'sharing' ORDER BY participant"),
                ElementsAre("P03", "P06", "P07", "P09"));
    EXPECT_THAT(test::column(path, granted + "0 AND what = 'sharing' ORDER BY participant"),
                ElementsAre("P01", "P02", "P04", "P05", "P08"));
  };
  expect_answers();  // reading makes a temporary copy
  open_database(path, Open::Write, read_schema_steps());
  expect_answers();
}

/// Earlier versions accepted any form of these questions; an answer that could be a refusal counts as one.
TEST(Permission, OfAScaleThatIsNotNoAndYesIsRefused) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    test::add_people(store, test::asking_protocol(), {{"P01", 1, 1}});
  }
  EXPECT_THAT(test::permissions_of(path), ElementsAre("P01 gaze 1", "P01 sharing 1"));
  Connection(path, Open::Write).execute("UPDATE question SET scale_max = 2 WHERE code = 'gaze_kept'");
  Connection(path, Open::Write).execute("UPDATE question SET kind = 'scale' WHERE code = 'data_shared'");
  EXPECT_THAT(test::permissions_of(path), ElementsAre("P01 gaze 0", "P01 sharing 0"));
}

TEST(Permission, GoesWithWhoWithdraws) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    test::add_people(store, test::asking_protocol(), {{"P01", 1, 1}, {"P02", 1, 1}});
  }
  {
    Connection database(path, Open::Write);
    database.execute(
        "INSERT INTO permission_change (session_id, what, granted, utc) "
        "SELECT session_id, 'gaze', 1, 'now' FROM session");
    database.execute(
        "INSERT INTO gaze (presentation_id, sample_index, source, sampled_ns, device_ns, valid, x, y) "
        "SELECT presentation_id, 0, 'mouse', 0, NULL, 1, 0.5, 0.5 FROM presentation");
  }
  withdraw(path, "P01");
  const std::string whose = " JOIN session USING (session_id)";
  EXPECT_THAT(test::column(path, "SELECT participant FROM permission_change" + whose), ElementsAre("P02"));
  EXPECT_THAT(test::column(path,
                           "SELECT participant FROM gaze JOIN presentation USING (presentation_id) "
                           "JOIN trial USING (trial_id)" +
                               whose),
              ElementsAre("P02"));
}

TEST(PermissionChange, HoldsForAllSessionsAndIsLogged) {
  const test::TemporaryFolder folder;
  const fs::path path = test::gaze_of_two(folder);
  change_permissions(path, "P01", {.gaze = {}, .sharing = false});
  EXPECT_THAT(test::permissions_of(path), ElementsAre("P01 gaze 1", "P01 sharing 0", "P01 gaze 1",
                                                      "P01 sharing 0", "P02 gaze 1", "P02 sharing 1"));
  change_permissions(path, "P01", {.gaze = true, .sharing = true});
  EXPECT_THAT(test::permissions_of(path), ElementsAre("P01 gaze 1", "P01 sharing 1", "P01 gaze 1",
                                                      "P01 sharing 1", "P02 gaze 1", "P02 sharing 1"));
  EXPECT_THAT(test::column(path,
                           "SELECT session_id || ' ' || detail FROM event WHERE kind = 'permission changed' "
                           "ORDER BY event_id"),
              ElementsAre("1 sharing refused", "3 sharing refused", "1 gaze allowed", "3 gaze allowed",
                          "1 sharing allowed", "3 sharing allowed"));
  const auto sessions = read_permissions(path, "P01");
  ASSERT_EQ(sessions.size(), 2u);
  EXPECT_EQ(sessions[1].visit, 2);
  EXPECT_EQ(sessions[1].sharing, true);
}

TEST(PermissionChange, NoGazeLeavesNoByteOfItAndTheSessionGoesOn) {
  const test::TemporaryFolder folder;
  constexpr double telling = 0.7123456789;
  const fs::path path = test::gaze_of_two(folder, telling);
  std::string bytes(8, '\0');  // as SQLite stores a number
  std::memcpy(bytes.data(), &telling, 8);
  std::reverse(bytes.begin(), bytes.end());
  const auto stands = [&] { return test::bytes_of(path).find(bytes) != std::string::npos; };
  ASSERT_TRUE(stands());
  const PermissionChange done = change_permissions(path, "P01", {.gaze = false, .sharing = {}});
  EXPECT_EQ(done.gaze_deleted, 2);
  EXPECT_FALSE(stands());
  EXPECT_TRUE(!fs::exists(path.string() + "-wal") || fs::file_size(path.string() + "-wal") == 0);
  EXPECT_THAT(test::gaze_of(path), ElementsAre("P02"));
  Store store(path, Open::Write);
  const auto runs = store.open_runs();
  EXPECT_EQ(runs.at(0).sessions.at(0).units.size(), 1u);
  EXPECT_FALSE(store.allows_gaze(runs.at(0).sessions.at(0).id));
  EXPECT_TRUE(store.allows_gaze(runs.at(0).sessions.at(1).id));
}

TEST(PermissionChange, ALaterAnswerCountsAgain) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    store.add_run(test::run_plan(test::asking_protocol(), {"P01"}));
  }
  change_permissions(path, "P01", {.gaze = true, .sharing = true});
  {
    Store store(path, Open::Write);
    EXPECT_TRUE(store.allows_gaze(1));
    test::answer_consent(store, store.open_runs().at(0).sessions.at(0), {"P01", 0, 0});
    EXPECT_FALSE(store.allows_gaze(1));
  }
  EXPECT_THAT(test::permissions_of(path), ElementsAre("P01 gaze 0", "P01 sharing 0"));
  change_permissions(path, "P01", {.gaze = true, .sharing = {}});
  EXPECT_THAT(test::permissions_of(path), ElementsAre("P01 gaze 1", "P01 sharing 0"));
}

TEST(PermissionChange, NamesBackupsWithGazeAndPublicExports) {
  const test::TemporaryFolder folder;
  const fs::path path = test::gaze_of_two(folder);
  fs::copy_file(path, path.string() + ".v3-then.bak");
  fs::copy_file(fs::path(VIP_TEST_DIR) / "libstudy/fixtures/study_v2.db", path.string() + ".v2-then.bak");
  {
    Connection database(path, Open::Write);
    const auto exported = [&](const std::string& kind, const std::string& place, bool with_person) {
      database.execute("INSERT INTO export (kind, path, host, sha256, utc, tackled) VALUES ('" + kind +
                       "', '" + place + "', '', '', 'now', 0)");
      if (with_person) {
        database.execute(
            "INSERT INTO export_person SELECT last_insert_rowid(), person FROM session WHERE participant = "
            "'P01' LIMIT 1");
      }
    };
    exported("bids", "/shared/bids", true);
    exported("csv", "/private/csv", true);
    exported("psych-ds", "/of/others", false);
    exported("unknown", "/of/old", true);
  }
  const PermissionChange done = change_permissions(path, "P01", {.gaze = false, .sharing = false});
  EXPECT_THAT(done.backups, ElementsAre(path.string() + ".v3-then.bak"));
  EXPECT_THAT(done.gaze_exports, ElementsAre("/shared/bids", "/private/csv", "/of/old"));
  EXPECT_THAT(done.exports, ElementsAre("/shared/bids", "/of/old"));
}

TEST(PermissionChange, OfNobodyOrDuringASessionIsAnError) {
  const test::TemporaryFolder folder;
  const fs::path path = test::gaze_of_two(folder);
  const auto change = [&](const std::string& who) {
    change_permissions(path, who, {.gaze = false, .sharing = {}});
  };
  EXPECT_THAT([&] { change("P09"); }, ThrowsMessage<base::Error>(HasSubstr("knows no participant P09")));
  {
    Store store(path, Open::Write);
    EXPECT_THAT([&] { change("P01"); }, ThrowsMessage<base::Error>(HasSubstr("mend: ")));
  }
  EXPECT_EQ(test::gaze_of(path).size(), 3u);
  withdraw(path, "P02");
  EXPECT_THAT([&] { change("P02"); }, ThrowsMessage<base::Error>(HasSubstr("P02 withdrew")));
}

}  // namespace
}  // namespace study
