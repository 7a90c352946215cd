/// vip-study salvage, from its command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "libstudy/store/file/journal_file.hpp"
#include "libstudy/store/file/writer_lock.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A study of two people, and the command that salvages it.
class SalvageCommandE2e : public ::testing::Test {
 protected:
  SalvageCommandE2e() {
    base::write_file_atomically(folder_ / "short.toml", short_protocol("1"));
    const Ended ran = Process(run_arguments(folder_ / "short.toml", database_,
                                            {"--clock", "virtual", "--participants", "2"}))
                          .wait();
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    given_ = answers_in(database_);
    EXPECT_FALSE(given_.empty());
  }

  /// The line of the program's report for a source from which all answers were recovered.
  std::string all_from(const std::string& where) const {
    return "  " + std::to_string(given_.size()) + " answers from " + where + "\n";
  }

  /// Destroys every page except the first.
  void destroy() {
    const auto size = static_cast<std::streamoff>(fs::file_size(database_));
    std::fstream file(database_, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(4096);
    file << std::string(static_cast<std::size_t>(size - 4096), '\0');
  }

  Ended salvage() const { return Process({vip_study, "salvage", "--db", database_, "--into", made_}).wait(); }

  /// Expects all answers, whatever their rows' numbers.
  void expect_all_answers() const {
    const Answers found = answers_in(made_);
    ASSERT_EQ(found.size(), given_.size());
    for (const auto& [key, answer] : given_) {
      ASSERT_TRUE(found.contains(key));
      EXPECT_EQ(std::get<1>(found.at(key)), std::get<1>(answer));
      EXPECT_EQ(std::get<2>(found.at(key)), std::get<2>(answer));
    }
  }

  const TemporaryFolder folder_;
  const std::string database_ = folder_ / "s.db", made_ = folder_ / "new.db";
  Answers given_;
};

TEST_F(SalvageCommandE2e, MakesADatabaseOfADamagedOneAndItsJournal) {
  destroy();
  const std::string damaged = base::read_file(database_, 1u << 30);
  EXPECT_EQ(Process({vip_study, "status", "--db", database_}).wait().exit_code, 1);
  const Ended done = salvage();
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out,
              AllOf(HasSubstr(database_ + ": damaged, cut short or gone"),
                    HasSubstr(made_ + ": 2 sessions, 0 frames"), HasSubstr("  0 answers from the database\n"),
                    HasSubstr(all_from("the journal alone")), HasSubstr("lost: times of ")));
  expect_all_answers();
  EXPECT_TRUE(base::read_file(database_, 1u << 30) == damaged);
  EXPECT_EQ(Process({vip_study, "resume", "--db", made_}).wait().exit_code, 0);
  const Ended again = salvage();
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, AllOf(HasSubstr(made_ + ": exists"), HasSubstr("mend: ")));
}

TEST_F(SalvageCommandE2e, CountsWhatComesFromWhere) {
  fs::remove(study::journal_beside(database_));
  const Ended sound = salvage();
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_THAT(sound.out, AllOf(HasSubstr("SQLite finds nothing wrong"), HasSubstr(all_from("the database")),
                               HasSubstr("  0 answers from the journal alone (there is none)\n")));
  expect_all_answers();
  fs::remove(made_);
  fs::remove(study::journal_beside(made_));
  destroy();
  const Ended nothing = salvage();
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, AllOf(HasSubstr(database_), HasSubstr("nothing of a study"), HasSubstr("mend: ")));
  EXPECT_FALSE(fs::exists(made_));
}

TEST_F(SalvageCommandE2e, WaitsForNobodyWhoWritesTheDatabase) {
  {
    const study::WriterLock session(database_);
    const Ended refused = salvage();
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("another vip-study is running"), HasSubstr("mend: ")));
    EXPECT_FALSE(fs::exists(made_));
  }
  EXPECT_EQ(salvage().exit_code, 0);
}

}  // namespace
}  // namespace apps::test
