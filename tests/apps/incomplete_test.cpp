/// A database that lacks records which its journal holds: every command that reads it says so, and continues
/// only with --incomplete.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/json.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class IncompleteE2e : public ::testing::Test {
 protected:
  /// Answers of P01 and P02 to Task 2 and a pilot; P03's are only in the journal.
  IncompleteE2e() {
    run("protocols/task2.toml", {"P01", "P02"});
    run("protocols/ptpe_pilot.toml", {"P01", "P02"});
    const std::string before = base::read_file(database_, 1u << 30);
    run("protocols/ptpe_pilot.toml", {"P03"});
    base::write_file_atomically(database_, before);
  }

  void run(const std::string& protocol, const std::vector<std::string>& people) {
    std::vector<std::string> arguments{vip_study, "run", protocol, "--db", database_, "--observer", "random"};
    for (const std::string& code : people) arguments.insert(arguments.end(), {"--participant", code});
    const Ended ended = Process(arguments).wait();
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
  }

  TemporaryFolder folder_;
  std::string database_ = folder_ / "study.db", page_ = folder_ / "r.html", json_ = folder_ / "r.json",
              task_ = folder_ / "t.json", csv_ = folder_ / "csv", all_ = folder_ / "all.db";
};

TEST_F(IncompleteE2e, IsSaidByEveryReaderThatGoesOnOnlyWhenTold) {
  const std::string stats = VIP_BIN_DIR "/vip-stats";
  const std::vector<std::vector<std::string>> commands{
      {vip_study, "status", "--db", database_},
      {vip_study, "consent", "P01", "--db", database_},
      {vip_study, "export", "--db", database_, "--csv", csv_},
      {vip_study, "merge", database_, "--into", all_},
      {stats, "report", database_, "--html", page_, "--json", json_},
      {stats, "task2", database_, "--json", task_}};
  for (const auto& command : commands) {
    SCOPED_TRACE(command[1]);
    const Ended refused = Process(command).wait();
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("are in the journal only"), HasSubstr("--incomplete"),
                                   HasSubstr("vip-study salvage --db " + database_)));
    for (const std::string& made : {page_, json_, task_, csv_, all_}) EXPECT_FALSE(fs::exists(made)) << made;
  }
  for (auto command : commands) {
    SCOPED_TRACE(command[1]);
    command.emplace_back("--incomplete");
    const Ended done = Process(command).wait();
    EXPECT_EQ(done.exit_code, 0) << done.err;
    if (command[1] != "report") {
      EXPECT_THAT(done.out, HasSubstr("are in the journal only"));
    }
  }
  EXPECT_THAT(base::read_file(page_, 1u << 30), HasSubstr("are in the journal only"));
  for (const std::string& file : {json_, task_}) {
    const auto json = base::Json::parse(base::read_file(file, 1u << 30));
    EXPECT_THAT(json["study"]["incomplete"].get<std::string>(), HasSubstr("are in the journal only"));
  }
  EXPECT_THAT(Process({stats, "task1", database_}).wait().err, HasSubstr("--incomplete"));
  // The fit of random answers fails, but only after reading.
  const Ended fit = Process({stats, "fit-ptpe", database_, "--json", folder_ / "fit.json"}).wait();
  EXPECT_THAT(fit.err, HasSubstr("--incomplete"));
  EXPECT_FALSE(fs::exists(folder_ / "fit.json"));
  Process({stats, "fit-ptpe", database_, "--json", folder_ / "fit.json", "--incomplete"}).wait();
  EXPECT_TRUE(base::Json::parse(base::read_file(folder_ / "fit.json", 1u << 30)).contains("incomplete"));
}

TEST_F(IncompleteE2e, IsMadeWholeByTheCommandThatTheMessageNames) {
  const std::string whole = folder_ / "whole.db";
  EXPECT_EQ(Process({vip_study, "salvage", "--db", database_, "--into", whole}).wait().exit_code, 0);
  const Ended status = Process({vip_study, "status", "--db", whole}).wait();
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_THAT(status.out, HasSubstr("P03"));
}

}  // namespace
}  // namespace apps::test
