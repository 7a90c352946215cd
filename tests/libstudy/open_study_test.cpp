/// Reading a database whose journal of answers has records that the database lacks or has otherwise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/permissions.hpp"
#include "libstudy/store/read/sickness.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

class OpeningToRead : public ::testing::Test {
 protected:
  OpeningToRead() : path_(test::gaze_of_two(folder_)) {}

  /// Restores an earlier database beside the current journal.
  void put_back(const std::string& bytes) const {
    for (const char* part : {"-wal", "-shm"}) fs::remove(path_.string() + part);
    base::write_file_atomically(path_, bytes);
  }
  std::vector<std::string> seen(const std::string& sql) const {
    std::vector<std::string> out;
    const auto opened = open_study({path_, true});
    for (sqlite::Statement row(*opened.database, sql); row.step();) out.push_back(row.text(0));
    return out;
  }
  std::vector<std::string> people_seen() const {
    return seen("SELECT DISTINCT participant FROM session ORDER BY 1");
  }
  std::vector<std::string> gaze_seen() const {
    return seen(
        "SELECT participant FROM gaze JOIN presentation USING (presentation_id) JOIN trial USING (trial_id) "
        "JOIN session USING (session_id) ORDER BY 1");
  }

  test::TemporaryFolder folder_;
  fs::path path_;
};

TEST_F(OpeningToRead, OfAWholeStudyLacksNothing) {
  EXPECT_EQ(open_study(path_).lacking, "");
  EXPECT_EQ(lacking_of(path_), "");
}

TEST_F(OpeningToRead, WithoutItsLogIsRefusedByEveryReaderAndGoesOnOnlyWhenTold) {
  const fs::path copy = folder_ / "copied.db";
  {
    Store store(path_, Open::Write);
    const auto session = store.open_runs().at(0).sessions.at(0);
    test::answer_one(store, session, session.units.at(0), "rating", test::score(3));
    fs::copy_file(path_, copy);
    fs::copy_file(journal_beside(path_), journal_beside(copy));
  }
  const auto refused = ThrowsMessage<base::Error>(
      AllOf(HasSubstr("copied.db.answers.jsonl"), HasSubstr("1 answers and "), HasSubstr("--incomplete")));
  EXPECT_THAT([&] { read_status(copy); }, refused);
  EXPECT_THAT([&] { read_tasks(copy); }, refused);
  EXPECT_THAT([&] { read_sickness(copy); }, refused);
  EXPECT_THAT([&] { read_certificate(copy, 1, FpsMean::Harmonic); }, refused);
  EXPECT_THAT([&] { read_permissions(copy, "P01"); }, refused);
  EXPECT_THAT([&] { requested_withdrawals(copy); }, refused);
  EXPECT_THAT([&] { RegisteredFiles{copy}; }, refused);
  EXPECT_THAT([&] { export_csv(copy, folder_ / "csv"); }, refused);
  EXPECT_THAT([&] { export_bids(copy, folder_ / "bids"); }, refused);
  EXPECT_THAT([&] { export_psych_ds(copy, folder_ / "psych_ds"); }, refused);
  EXPECT_THAT([&] { merge({copy}, folder_ / "merged.db"); }, refused);
  EXPECT_THAT(read_tasks({copy, true}).lacking, HasSubstr("1 answers and "));
  EXPECT_EQ(read_status({copy, true}).lacking, lacking_of(copy));
  EXPECT_EQ(merge({copy}, folder_ / "merged.db", true).sessions, 3);
  // The export's own event must not have the number of an event that only the journal has.
  const std::string lacking = lacking_of(copy);
  export_csv({copy, true}, folder_ / "csv");
  EXPECT_EQ(lacking_of(copy), lacking);
  // Salvage is the remedy that the message names.
  EXPECT_EQ(salvage(copy, folder_ / "whole.db").answers_journal, 1);
  EXPECT_EQ(lacking_of(folder_ / "whole.db"), "");
}

TEST_F(OpeningToRead, OfABackupThatWasPutBackShowsNobodyWhoWithdrew) {
  const std::string before = test::bytes_of(path_);
  withdraw(path_, "P01");
  put_back(before);
  ASSERT_EQ(Connection(path_, Open::Read).integer("SELECT count(*) FROM session WHERE participant = 'P01'"),
            2);
  EXPECT_THAT([&] { read_status(path_); }, ThrowsMessage<base::Error>(HasSubstr("salvage")));
  EXPECT_THAT(people_seen(), ElementsAre("P02"));
  EXPECT_THAT(gaze_seen(), ElementsAre("P02"));
  EXPECT_THAT(read_status({path_, true}).withdrawn, ElementsAre("P01"));
  export_csv({path_, true}, folder_ / "csv", {.words = true, .gaze = true});
  EXPECT_THAT(test::bytes_of(folder_ / "csv/sessions.csv"), AllOf(HasSubstr("P02"), Not(HasSubstr("P01"))));
  EXPECT_THAT(merge({path_}, folder_ / "merged.db", true).withdrawn, ElementsAre("P01"));
  EXPECT_THAT(salvage(path_, folder_ / "whole.db").withdrawn, ElementsAre("P01"));
  path_ = folder_ / "whole.db";
  EXPECT_EQ(open_study(path_).lacking, "");
  EXPECT_THAT(people_seen(), ElementsAre("P02"));
}

TEST_F(OpeningToRead, OfABackupThatWasPutBackObeysARefusalMadeSince) {
  const std::string before = test::bytes_of(path_);
  change_permissions(path_, "P01", {.gaze = false, .sharing = false});
  put_back(before);
  EXPECT_THAT([&] { export_bids(path_, folder_ / "bids", true); },
              ThrowsMessage<base::Error>(HasSubstr("salvage")));
  EXPECT_EQ(export_bids({path_, true}, folder_ / "bids", true).people.refused, 1);
  EXPECT_THAT(gaze_seen(), ElementsAre("P02"));
}

/// A command that changes permissions is killed after it wrote the journal's line and before the commit.
TEST_F(OpeningToRead, SeesACommitThatWasCutShort) {
  const std::string before = test::bytes_of(path_), journal = test::bytes_of(journal_beside(path_));
  change_permissions(path_, "P01", {.gaze = false, .sharing = false});
  const std::string written = test::bytes_of(journal_beside(path_));
  put_back(before);
  base::write_file_atomically(
      journal_beside(path_),
      written.substr(0, written.find('\n', written.find("{\"ready\"", journal.size())) + 1));
  EXPECT_EQ(open_study(path_).lacking, "");
  EXPECT_THAT(gaze_seen(), ElementsAre("P02"));
  EXPECT_EQ(test::gaze_of(path_).size(), 3u);  // reading wrote nothing to the database
  // The export's own event must not have the number of an event in the uncommitted change.
  EXPECT_EQ(export_bids(path_, folder_ / "bids", true).people.refused, 1);
  Store(path_, Open::Write);
  EXPECT_THAT(test::gaze_of(path_), ElementsAre("P02"));
}

TEST_F(OpeningToRead, OfAWithdrawalThatWasCutShortLeavesThePersonOutAndAWriterFinishesIt) {
  const std::string person =
      test::column(path_, "SELECT person FROM session WHERE participant = 'P01'").front();
  fs::copy_file(path_, path_.string() + ".v6-then.bak");
  std::ofstream(journal_beside(path_), std::ios::app) << rewrite_line({person});
  EXPECT_THAT(people_seen(), ElementsAre("P02"));
  Store(path_, Open::Write);
  EXPECT_EQ(test::column(path_, "SELECT participant FROM tombstone"), std::vector<std::string>{"P01"});
  EXPECT_THAT(test::column(path_, "SELECT participant FROM session"), ElementsAre("P02"));
  EXPECT_THAT(test::column(path_, "SELECT kind FROM chore"), IsEmpty());
  EXPECT_EQ(Connection(path_.string() + ".v6-then.bak", Open::Read).integer("SELECT count(*) FROM session"),
            1);
  EXPECT_TRUE(read_journal(journal_beside(path_)).forgotten.empty());
}

/// A reader beside a session must not take the session's open transaction for lost data.
TEST_F(OpeningToRead, BesideASessionThatWritesIsNeverRefused) {
  Store store(path_, Open::Write);
  std::atomic<bool> done = false;
  std::thread writer([&] {
    for (int i = 0; i < 60; ++i) store.note(1, {}, "note " + std::to_string(i));
    done = true;
  });
  int read = 0;
  do {
    EXPECT_NO_THROW(read_status(path_));
    ++read;
  } while (!done);
  writer.join();
  EXPECT_GE(read, 1);
}

}  // namespace
}  // namespace study
