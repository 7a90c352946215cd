/// vip-stats task1 and task2 on databases that vip-study wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using ::test::TemporaryFolder;
using ::testing::HasSubstr;

apps::test::Ended program(const std::string& line) { return apps::test::run_shell(VIP_BIN_DIR "/" + line); }

std::string study(const std::string& protocol, int participants, const std::string& observer,
                  const fs::path& database) {
  return "vip-study run " + base::resource("protocols/" + protocol + ".toml").string() + " --participants " +
         std::to_string(participants) + " --observer " + observer + " --db " + database.string();
}

nlohmann::json json_of(const fs::path& path) { return nlohmann::json::parse(base::read_file(path, 1 << 24)); }

/// One folder with a database of both tasks for all tests.
class TaskCommandsE2e : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    database_ = *folder_ / "study.db";
    ASSERT_EQ(program(study("task1", 6, "random", database_)).exit_code, 0);
    ASSERT_EQ(program(study("task2", 6, "random", database_)).exit_code, 0);
  }
  static void TearDownTestSuite() { delete folder_; }

  inline static TemporaryFolder* folder_ = nullptr;
  inline static fs::path database_;
};

TEST_F(TaskCommandsE2e, WriteTheirResultsAsJsonAndTables) {
  for (const std::string task : {"task1", "task2"}) {
    const fs::path json = *folder_ / (task + ".json"), csv = *folder_ / (task + "_csv");
    const auto ended = program("vip-stats " + task + " --db " + database_.string() + " --json " +
                               json.string() + " --csv " + csv.string());
    ASSERT_EQ(ended.exit_code, 0) << ended.out;
    EXPECT_THAT(ended.out, HasSubstr("6 participants, 60 of 60 answered trials analysed"));
    const auto results = json_of(json);
    EXPECT_EQ(results.at("flow").at(task).at("trials_analysed"), 60);
    EXPECT_EQ(results.at("study").at("simulated"), 6);
    EXPECT_EQ(results.at("hypotheses").size(), 3u);
    EXPECT_TRUE(fs::exists(csv / "hypotheses.csv"));
    EXPECT_EQ(results.contains("task1"), task == "task1");
  }
}

TEST_F(TaskCommandsE2e, TimingIsThatOfTheProtocol) {
  const fs::path json = *folder_ / "timing.json";
  ASSERT_EQ(program("vip-stats task1 " + database_.string() + " --json " + json.string()).exit_code, 0);
  int showings = 0;
  const auto results = json_of(json);
  for (const auto& cell : results.at("timing")) {
    EXPECT_NEAR(cell.at("realised_mean_fps").get<double>(), cell.at("nominal_mean_fps").get<double>(), 0.05);
    showings += cell.at("showings").get<int>();
  }
  EXPECT_EQ(showings, 60);
}

TEST_F(TaskCommandsE2e, AnalysingTwiceGivesTheSame) {
  const auto once = [&](const char* name) {
    EXPECT_EQ(
        program("vip-stats task2 " + database_.string() + " --json " + (*folder_ / name).string()).exit_code,
        0);
    auto json = json_of(*folder_ / name);
    json.erase("date_utc");
    return json;
  };
  EXPECT_EQ(once("a.json"), once("b.json"));
}

TEST_F(TaskCommandsE2e, ThePlanDecides) {
  const fs::path plan = *folder_ / "plan.toml", json = *folder_ / "plan.json";
  base::write_file_atomically(plan, "format = 1\nalpha = 0.01\n[margins]\nrealism = 1.5\n");
  const auto ended = program("vip-stats task1 " + database_.string() + " --plan " + plan.string() +
                             " --json " + json.string());
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const auto results = json_of(json);
  EXPECT_EQ(results.at("plan").at("source"), "plan.toml");
  EXPECT_EQ(results.at("plan").at("alpha"), 0.01);
  EXPECT_EQ(results.at("hypotheses")[1].at("tests")[0].at("margin"), 1.5);
  EXPECT_NEAR(results.at("hypotheses")[1].at("tests")[0].at("ci_confidence").get<double>(), 0.99, 1e-12);
}

TEST_F(TaskCommandsE2e, BadInputIsNamedAndNothingIsWritten) {
  const auto refuse = [&](const std::string& arguments, const std::string& what) {
    const auto ended = program("vip-stats " + arguments);
    EXPECT_NE(ended.exit_code, 0) << arguments;
    EXPECT_THAT(ended.out, HasSubstr(what)) << arguments;
  };
  const std::string database = database_.string(), json = (*folder_ / "none.json").string();
  refuse("task1", "database");
  refuse("task1 " + (*folder_ / "missing.db").string() + " --json " + json, "missing.db");
  refuse("task1 " + database + " --json " + database, "is the database");
  refuse("task1 " + database + " --protocol ffff --json " + json, "ffff");
  refuse("task1 " + database + " --plan " + database + " --json " + json, "study.db");
  EXPECT_FALSE(fs::exists(json));
  EXPECT_EQ(program("vip-stats task1 " + database).exit_code, 0) << "the database is whole";
}

}  // namespace
