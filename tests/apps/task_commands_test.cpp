/// vip-stats task1 and task2 on databases that vip-study wrote.

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/task_database.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using ::test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

apps::test::Ended program(const std::string& line) { return apps::test::run_shell(VIP_BIN_DIR "/" + line); }

std::string study(const std::string& protocol, int participants, const std::string& observer,
                  const fs::path& database) {
  return "vip-study run " + base::resource("protocols/" + protocol + ".toml").string() + " --participants " +
         std::to_string(participants) + " --observer " + observer + " --db " + database.string();
}

base::Json json_of(const fs::path& path) { return base::Json::parse(base::read_file(path, 1 << 24)); }

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
    if (task == "task1") continue;
    for (const auto& pair : results.at("task2").at("pairs")) {
      const std::string name = pair.contains("by_person")
                                   ? pair.at("by_person").at("ci_name").get<std::string>()
                                   : "Clopper-Pearson";
      EXPECT_THAT(ended.out, ::testing::ContainsRegex("\ninterval.*: " + name.substr(0, 9)));
    }
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
  refuse("task1 " + database + " --json " + database + ".answers.jsonl", "is a file of the database");
  refuse("task1 " + database + " --json " + database + "-wal", "is a file of the database");
  refuse("task1 " + database + " --protocol ffff --json " + json, "ffff");
  refuse("task1 " + database + " --plan " + database + " --json " + json, "study.db");
  EXPECT_FALSE(fs::exists(json));
  EXPECT_EQ(program("vip-stats task1 " + database).exit_code, 0) << "the database is whole";
}

/// The words of the line that starts with `beginning`; empty if there is no such line.
Words line_of(const std::string& out, const std::string& beginning) {
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(beginning + " ")) continue;
    std::istringstream words(line.substr(beginning.size()));
    return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

/// The words that a pair's line must have according to the results: chosen, answers, share, p, p after Holm,
/// interval, test.
Words line_of(const base::Json& pair) {
  const bool people = pair.contains("by_person");
  const auto& tested = people ? pair.at("by_person") : pair;
  const auto& ci = tested.at(people ? "ci" : "clopper_pearson");
  const auto text = [](const base::Json& value, int decimals) {
    return fmt::format("{:.{}f}", value.get<double>(), decimals);
  };
  return {text(pair.at("k"), 0),   text(pair.at("n"), 0),         text(tested.at("share"), 2),
          text(pair.at("p"), 4),   text(pair.at("p_holm"), 4),    "[" + text(ci.at(0), 2) + ",",
          text(ci.at(1), 2) + "]", people ? "shares" : "binomial"};
}

/// Six people's answers to all ten pairs. `again`: also a second visit that answers the first pair.
std::vector<task_database::Trial> answers_of_six(bool again) {
  const Words methods{"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"};
  std::vector<task_database::Trial> out;
  for (int person = 0; person < 6; ++person) {
    const auto add = [&](int visit, int position, const std::string& a, const std::string& b, int chosen) {
      out.push_back({"P0" + std::to_string(person + 1),
                     visit,
                     position,
                     "data/scenes/single_dam.toml",
                     "32k",
                     a,
                     b,
                     {{"preference", chosen}}});
    };
    int position = 0;
    for (std::size_t a = 0; a < methods.size(); ++a)
      for (std::size_t b = a + 1; b < methods.size(); ++b, ++position)
        add(1, position, methods[a], methods[b], (person + position) % 3 == 0 ? 1 : 2);
    if (again) add(2, 0, methods[0], methods[1], person % 2 == 0 ? 1 : 2);
  }
  return out;
}

struct Task2Output {
  std::string lines;
  base::Json results;
};

/// The name of a pair's interval according to the lines; empty if no line names it, or two lines differ.
std::string interval_name(const std::string& lines, const std::string& pair) {
  std::set<std::string> names;
  std::istringstream all(lines);
  for (std::string line; std::getline(all, line);) {
    const auto colon = line.rfind(": ");
    if (line.starts_with("intervals: ") ||
        (line.starts_with("interval of ") &&
         (line.substr(12, colon - 12) + ",").find(pair + ",") != std::string::npos))
      names.insert(line.substr(colon + 2));
  }
  return names.size() == 1 ? *names.begin() : "";
}

/// What vip-stats task2 prints and writes for these answers. Compares each pair's line with the results.
Task2Output task2_of_six(bool again) {
  const TemporaryFolder folder;
  task_database::write(folder / "study.db", study::read_protocol(base::resource("protocols/task2.toml")),
                       answers_of_six(again));
  const auto ended = program("vip-stats task2 " + (folder / "study.db").string() + " --json " +
                             (folder / "out.json").string());
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  const auto results = json_of(folder / "out.json").at("task2");
  for (const auto& pair : results.at("pairs")) {
    const auto name = pair.at("a").get<std::string>() + " over " + pair.at("b").get<std::string>();
    EXPECT_EQ(line_of(ended.out, name), line_of(pair)) << name;
    const bool people = pair.contains("by_person");
    EXPECT_EQ(interval_name(ended.out, name),
              people ? pair.at("by_person").at("ci_name").get<std::string>() : "Clopper-Pearson")
        << name << "\n"
        << ended.out;
  }
  return {ended.out, results};
}

TEST(Task2LinesE2e, SayWhichTestEachPairGotAndWhyThereAreNoTriads) {
  const auto [lines, results] = task2_of_six(true);
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_EQ(line_of(results.at("pairs").at(i)).back(), i == 0 ? "shares" : "binomial");
  const std::string several = "6 of 6 participants answered a pair more than once, at most 2 times.\n";
  const auto at = lines.find(several);
  ASSERT_NE(at, std::string::npos) << lines;
  EXPECT_EQ(lines.find(several, at + 1), std::string::npos) << "said once, not at each pair";
  for (const char* rule : {"tests", "more_than_one_trial"})
    EXPECT_THAT(lines, HasSubstr(results.at("rules").at(rule).get<std::string>() + "\n"));
  EXPECT_THAT(lines, HasSubstr("Circular triads are not given: " +
                               results.at("triads").at("refused").get<std::string>() + ".\n"));
}

TEST(Task2LinesE2e, OneAnswerOfEachPersonIsTestedAsSuch) {
  const auto [lines, results] = task2_of_six(false);
  for (const auto& pair : results.at("pairs")) EXPECT_EQ(line_of(pair).back(), "binomial");
  for (const char* words : {"shares", "more than once", "Circular triads"})
    EXPECT_THAT(lines, Not(HasSubstr(words)));
}

}  // namespace
