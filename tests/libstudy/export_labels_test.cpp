/// Public labels of people and protocols never change once given.
#include "libstudy/store/export_labels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;
using sqlite::Open;
using sqlite::Statement;
using ::testing::ElementsAre;

class GivenLabels : public ::testing::Test {
 protected:
  void add(const fs::path& database, const std::vector<std::string>& codes) {
    Store(database, Open::Create).add_run(test::run_plan(test::pairs(), codes));
  }
  /// Adds a person as planned by a version without rules for codes and without labels.
  void add_old(const fs::path& database, const std::string& code) {
    add(database, {"OLD"});
    Connection(database, Open::Write)
        .execute("UPDATE session SET participant = '" + code + "', code = '" + code +
                 "' WHERE participant = 'OLD'; DELETE FROM label WHERE label = 'OLD'");
    fs::remove(database.string() + ".answers.jsonl");
  }
  /// Lines "code label" of all people.
  static std::vector<std::string> people(const fs::path& database) {
    Connection look(database, Open::Read);
    std::vector<std::string> lines;
    Statement row(
        look,
        "SELECT DISTINCT participant || ' ' || label FROM session JOIN label ON kind = 'person' AND "
        "owner = person ORDER BY 1");
    while (row.step()) lines.push_back(row.text(0));
    return lines;
  }
  std::string published(const fs::path& database) {
    export_bids(database, folder / "bids");
    return test::bytes_of(folder / "bids" / "participants.tsv");
  }

  test::TemporaryFolder folder;
  const fs::path path = folder / "study.db";
};

TEST_F(GivenLabels, OfWhoWasThereFirstStaysWhenALikeCodeComes) {
  add(path, {"P01"});
  EXPECT_EQ(published(path), "participant_id\tcode\tsimulated\nsub-P01\tP01\t1\n");
  add_old(path, "P-01");
  EXPECT_EQ(published(path), "participant_id\tcode\tsimulated\nsub-P01x2\tP-01\t1\nsub-P01\tP01\t1\n");
  add(path, {"A01"});
  EXPECT_THAT(people(path), ElementsAre("A01 A01", "P-01 P01x2", "P01 P01"));
}

TEST_F(GivenLabels, OfOlderDatabasesAreThoseThatWerePublishedLast) {
  add_old(path, "P01");
  add_old(path, "P-01");
  add_old(path, "p01");
  Connection(path, Open::Write).execute("DELETE FROM label");
  // Labels must differ in more than case, because some file systems ignore case.
  EXPECT_EQ(published(path),
            "participant_id\tcode\tsimulated\nsub-P01\tP-01\t1\nsub-P01x2\tP01\t1\nsub-p01x3\tp01\t1\n");
}

TEST_F(GivenLabels, AreNotGivenAgainAfterAWithdrawal) {
  add(path, {"P01"});
  withdraw(path, "P01");
  add_old(path, "P-01");
  EXPECT_EQ(published(path), "participant_id\tcode\tsimulated\nsub-P01x2\tP-01\t1\n");
}

// The P01 of south.db was planned first, so it gets the label P01 in a new database. Merged into study.db,
// whose own P01 has that label already, it gets P01x2.
TEST_F(GivenLabels, OfTheDatabaseThatTakesOthersInStay) {
  const fs::path south = folder / "south.db";
  add(south, {"P01", "P03"});
  Connection(south, Open::Write).execute("UPDATE run SET started_utc = '1999-01-01T00:00:00Z'");
  fs::remove(south.string() + ".answers.jsonl");
  add(path, {"P01", "P02"});
  const auto label_of = [&](const fs::path& database, const std::string& person) {
    return Connection(database, Open::Read).text("SELECT label FROM label WHERE owner = '" + person + "'");
  };
  const auto person_of = [&](const fs::path& database) {
    return Connection(database, Open::Read).text("SELECT person FROM session WHERE participant = 'P01'");
  };
  const std::string ours = person_of(path), theirs = person_of(south);
  merge({south, path}, folder / "new.db");
  EXPECT_EQ(label_of(folder / "new.db", theirs), "P01");
  for (int times = 0; times < 2; ++times) {
    merge({south}, path);
    EXPECT_EQ(label_of(path, ours), "P01");
    EXPECT_EQ(label_of(path, theirs), "P01x2");
  }
}

TEST_F(GivenLabels, OfAMergeDoNotDependOnTheOrderOfItsSources) {
  const fs::path south = folder / "south.db";
  add(path, {"P01", "P02"});
  add(south, {"P01", "P03"});
  merge({path, south}, folder / "a.db");
  merge({south, path}, folder / "b.db");
  EXPECT_EQ(people(folder / "a.db"), people(folder / "b.db"));
  merge({folder / "a.db", south}, folder / "b.db");
  EXPECT_EQ(people(folder / "a.db"), people(folder / "b.db")) << "merged twice";
}

TEST_F(GivenLabels, OfProtocolsOfOneNameStay) {
  add(path, {"P05"});
  published(path);
  Protocol other = test::pairs();
  other.sha256 = std::string(64, 'a');
  other.version = "2.0";
  Store(path, Open::Write).add_run(test::run_plan(other, {"A01"}));  // A01 sorts before P05
  published(path);
  EXPECT_TRUE(fs::exists(folder / "bids" / "sub-P05" / "ses-pairsv1"));
  EXPECT_TRUE(fs::exists(folder / "bids" / "sub-A01" / "ses-pairsaaaaaav1"));
}

TEST_F(GivenLabels, AreSalvagedFromTheJournal) {
  add(path, {"P01"});
  add_old(path, "P-01");
  published(path);
  { const Store brought_together(path, Open::Write); }
  const auto before = people(path);
  for (const char* part : {"", "-wal", "-shm"}) fs::remove(path.string() + part);
  salvage(path, folder / "new.db");
  EXPECT_EQ(people(folder / "new.db"), before);
}

}  // namespace
}  // namespace study
