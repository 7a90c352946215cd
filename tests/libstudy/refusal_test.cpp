/// A refusal of gaze deletes all gaze, wherever the program that recorded the refusal was killed, and exports
/// follow the permissions whatever the database holds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/file.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double telling = 0.7123456789;

/// The bytes with which SQLite stores a number.
std::string bytes_of_number(double value) {
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), &value, 8);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// P01 and P02 allow gaze. P01 has a gaze sample, a head pose and a validation in each of two visits, P02 in
/// one visit.
fs::path make_study(const test::TemporaryFolder& folder) {
  const fs::path path = test::gaze_of_two(folder, telling);
  Connection(path, Open::Write)
      .execute(
          "INSERT INTO slot (presentation_id, slot_index, predicted_ns, period_ns, should_render) SELECT "
          "presentation_id, 0, 0, 1, 1 FROM presentation;"
          "INSERT INTO head (presentation_id, slot_index, x_m, place_tracked, turn_tracked) SELECT "
          "presentation_id, 0, 0.5, 1, 1 FROM presentation;"
          "INSERT INTO gaze_validation (session_id, validation, point, clock_ns, azimuth_deg, elevation_deg, "
          "samples, valid, passed) SELECT session_id, 1, 0, 0, 0, 0, 1, 1, 1 FROM session");
  Store(path, Open::Write);
  return path;
}

/// Rows of gaze, head and gaze_validation of a person.
std::vector<std::string> recorded_of(const fs::path& path, const std::string& participant) {
  const std::string whose = "participant = '" + participant + "'";
  const std::string joined =
      " JOIN presentation USING (presentation_id) JOIN trial USING (trial_id) JOIN "
      "session USING (session_id) WHERE " +
      whose;
  return test::column(path, "SELECT 'gaze' FROM gaze" + joined + " UNION ALL SELECT 'head' FROM head" +
                                joined +
                                " UNION ALL SELECT 'validation' FROM gaze_validation JOIN session USING "
                                "(session_id) WHERE " +
                                whose);
}

/// Copies of the database and its journal that can be written back later.
struct Files {
  std::string database, journal;
  explicit Files(const fs::path& path)
      : database(test::bytes_of(path)), journal(test::bytes_of(journal_beside(path))) {}
  void put(const fs::path& path) const {
    base::write_file_atomically(path, database);
    base::write_file_atomically(journal_beside(path), journal);
  }
};

TEST(Refusal, KilledAnywhereAroundItsCommitLeavesNoGazeOfWhoRefuses) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  const Files before(path);
  change_permissions(path, "P01", {.gaze = false, .sharing = {}});
  const std::string written = Files(path).journal;
  ASSERT_TRUE(written.starts_with(before.journal));
  const std::size_t ready = written.find("{\"ready\"", before.journal.size());
  ASSERT_NE(ready, std::string::npos);
  int refused = 0;
  for (std::size_t end = before.journal.size(); end <= written.size(); ++end) {
    if (end < written.size() && written[end - 1] != '\n') continue;
    if (end > written.find('\n', ready) + 1) break;  // beyond this line the database had committed
    SCOPED_TRACE(written.substr(before.journal.size(), end - before.journal.size()));
    Files cut = before;
    cut.journal = written.substr(0, end);
    cut.put(path);
    const bool named = !Store(path, Open::Write).left_to_clean().empty();
    EXPECT_FALSE(named);
    const bool is_refused = !test::permissions_of(path).front().ends_with("1");
    EXPECT_EQ(is_refused, end > ready);
    EXPECT_EQ(recorded_of(path, "P01").size(), is_refused ? 0u : 6u);
    EXPECT_EQ(recorded_of(path, "P02").size(), 3u);
    EXPECT_EQ(test::bytes_of(path).find(bytes_of_number(telling)) == std::string::npos, is_refused);
    refused += is_refused ? 1 : 0;
  }
  EXPECT_EQ(refused, 1);
}

/// A command that allows gaze again first completes the refusal, which deletes the refused gaze.
TEST(Refusal, ThatWasCutShortIsFinishedBeforeGazeIsAllowedAgain) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  Files files(path);
  change_permissions(path, "P01", {.gaze = false, .sharing = {}});
  const std::string written = Files(path).journal;
  files.journal = written.substr(0, written.find('\n', written.find("{\"ready\"", files.journal.size())) + 1);
  files.put(path);
  EXPECT_EQ(change_permissions(path, "P01", {.gaze = true, .sharing = {}}).gaze_deleted, 2);
  EXPECT_THAT(recorded_of(path, "P01"), IsEmpty());
  EXPECT_THAT(test::permissions_of(path), Contains("P01 gaze 1"));
}

TEST(Refusal, ThatIsFinishedLaterNamesBackupsAndExports) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  fs::copy_file(path, path.string() + ".v6-then.bak");
  export_csv(path, folder / "csv", {.words = false, .gaze = true});
  Store(path, Open::Write);  // writes the export to the journal too
  Files files(path);
  change_permissions(path, "P01", {.gaze = false, .sharing = {}});
  const std::string written = Files(path).journal;
  files.journal = written.substr(0, written.find('\n', written.find("{\"ready\"", files.journal.size())) + 1);
  files.put(path);
  EXPECT_THAT(Store(path, Open::Write).left_to_clean(),
              ElementsAre(HasSubstr(".v6-then.bak: holds gaze that P01 refused"), HasSubstr("csv on ")));
}

TEST(Refusal, OnAConsentPageDeletesWhatWasRecordedBefore) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
  {
    Store store(path, Open::Create);
    store.add_run(test::run_plan(test::asking_protocol(), {"P01"}));
  }
  change_permissions(path, "P01", {.gaze = true, .sharing = {}});
  Store store(path, Open::Write);
  const OpenSession session = store.open_runs().at(0).sessions.at(0);
  test::show(store, session, session.units.at(1));
  const GazeSample sample{5, {}, true, GazePoint{telling, 0.5}};
  store.add_gaze(1, 0, GazeOrigin::Mouse, {&sample, 1});
  ASSERT_THAT(test::gaze_of(path), ElementsAre("P01"));
  test::answer_consent(store, session, {"P01", 0, 1});
  EXPECT_THAT(test::gaze_of(path), IsEmpty());
  EXPECT_THAT(test::column(path, "SELECT kind FROM chore"), ElementsAre("rewrite"));
}

TEST(Refusal, InAMergeNamesTheExportsBesideTheResult) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), other = folder / "other.db";
  fs::copy_file(path, other);
  export_csv(path, folder / "csv", {.words = false, .gaze = true});
  change_permissions(other, "P01", {.gaze = false, .sharing = {}});
  EXPECT_THAT(merge({other}, path).beside.left, ElementsAre(HasSubstr("csv on ")));
  EXPECT_THAT(recorded_of(path, "P01"), IsEmpty());
  EXPECT_THAT(merge({other}, path).beside.left, IsEmpty());
}

TEST(Refusal, InAMergeNamesNoExportsOfAPersonWhoseGazeStays) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder), other = folder / "other.db";
  {
    Store store(path, Open::Write);
    test::add_people(store, test::asking_protocol(false), {{"P01", {}, 1}});  // is not asked about gaze
  }
  fs::copy_file(path, other);
  export_csv(path, folder / "csv", {.words = false, .gaze = true});
  EXPECT_THAT(merge({other}, path).beside.left, IsEmpty());
  EXPECT_EQ(recorded_of(path, "P01").size(), 6u);
  // The refusal deletes all gaze recorded before it, although the person then allows gaze again.
  change_permissions(other, "P01", {.gaze = false, .sharing = {}});
  change_permissions(other, "P01", {.gaze = true, .sharing = {}});
  EXPECT_THAT(merge({other}, path).beside.left, ElementsAre(HasSubstr("csv on ")));
  EXPECT_THAT(recorded_of(path, "P01"), IsEmpty());
}

/// The database has gaze rows of a person who refuses, as a kill, an earlier version or a fault may leave
/// them.
TEST(Refusal, KeepsGazeOutOfExportsThoughItStandsInTheDatabase) {
  const test::TemporaryFolder folder;
  const fs::path path = make_study(folder);
  Connection(path, Open::Write)
      .execute(
          "INSERT INTO permission_change (session_id, what, granted, utc) SELECT session_id, 'gaze', 0, "
          "'1970-01-01T00:00:00Z' FROM session WHERE participant = 'P01'");
  ASSERT_EQ(recorded_of(path, "P01").size(), 6u);
  export_csv(path, folder / "csv", {.words = false, .gaze = true});
  export_bids(path, folder / "bids", true);
  for (const char* file : {"gaze.csv", "heads.csv", "gaze_validations.csv"}) {
    const std::string text = test::bytes_of(folder / "csv" / file);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;  // the header and P02
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "bids"))
    files.push_back(entry.path().filename().string());
  EXPECT_THAT(files, Contains(::testing::AllOf(HasSubstr("sub-P02"), HasSubstr("acq-mouse_beh.tsv"))));
  EXPECT_THAT(files, Not(Contains(::testing::AllOf(HasSubstr("sub-P01"), HasSubstr("acq-mouse")))));
  EXPECT_THAT(files, Not(Contains(::testing::AllOf(HasSubstr("sub-P01"), HasSubstr("motion")))));
}

}  // namespace
}  // namespace study
