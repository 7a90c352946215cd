/// A run that is killed at any instant loses no answer and asks none twice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

/// Runs until `lines` answers were acknowledged and `delay` more, then kills. Returns all that was
/// acknowledged.
std::string run_and_kill(const std::vector<std::string>& arguments, int lines,
                         std::chrono::microseconds delay) {
  Process program(arguments);
  for (int i = 0; i < lines; ++i) program.read_line();
  std::this_thread::sleep_for(delay);
  program.send(SIGKILL);
  return program.wait().out;
}

/// Kills a run, resumes it, and checks every promise; returns the answers.
Answers check_one_kill(const std::string& database, const std::vector<std::string>& arguments, int lines,
                       std::chrono::microseconds delay, std::size_t planned) {
  const std::string told = run_and_kill(arguments, lines, delay);
  if (!fs::exists(database)) {
    EXPECT_TRUE(acknowledged(told).empty());
    EXPECT_EQ(run_program(arguments).exit_code, 0);
    return answers_in(database);
  }
  const Answers before = answers_in(database);
  // What was acknowledged is there; at most one more answer was safe but not yet told.
  const auto said = acknowledged(told);
  for (const auto& key : said) EXPECT_TRUE(before.count(key)) << key.first << " " << key.second;
  EXPECT_LE(before.size(), said.size() + 1);

  if (count_in(database, "SELECT count(*) FROM sqlite_schema") == 0 ||
      count_in(database, "SELECT count(*) FROM trial") == 0) {
    // Killed before the plan: nothing to resume, so the run is given again.
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(run_program(arguments).exit_code, 0);
    return answers_in(database);
  }
  const Ended resumed = run_program({vip_study, "resume", "--db", database, "--events"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  const Answers after = answers_in(database);
  EXPECT_EQ(after.size(), planned);
  for (const auto& [key, answer] : before) EXPECT_EQ(after.at(key), answer);
  for (const auto& key : acknowledged(resumed.out)) EXPECT_FALSE(before.count(key)) << "asked twice";
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM event WHERE kind = 'answered'"),
            static_cast<std::int64_t>(planned));
  EXPECT_EQ(count_in(database,
                     "SELECT count(*) FROM presentation p JOIN response r USING (trial_id) "
                     "WHERE p.presentation_id > r.presentation_id"),
            0);
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM presentation WHERE state = 'running'"), 0);
  return after;
}

std::map<std::pair<std::string, int>, int> scores(const Answers& answers) {
  std::map<std::pair<std::string, int>, int> scores;
  for (const auto& [key, answer] : answers) scores[key] = std::get<1>(answer);
  return scores;
}

TEST(StudyKillE2e, FourteenInstantsOnTheVirtualClock) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml";
  base::write_file_atomically(protocol, short_protocol("10"));
  const auto arguments = [&](const std::string& database) {
    return run_arguments(protocol, database, {"--participants", "4"});
  };
  ASSERT_EQ(run_program(arguments(folder / "whole.db")).exit_code, 0);
  const auto whole = scores(answers_in(folder / "whole.db"));
  ASSERT_EQ(whole.size(), 24u);

  std::mt19937 random(1);
  for (int kill = 0; kill < 14; ++kill) {
    SCOPED_TRACE(kill);
    const std::string database = folder / ("kill" + std::to_string(kill) + ".db");
    const int lines = static_cast<int>(random() % 24);
    const std::chrono::microseconds delay(random() % 20000);
    EXPECT_EQ(scores(check_one_kill(database, arguments(database), lines, delay, 24)), whole);
  }
}

TEST(StudyKillE2e, SixInstantsOnTheRealClockKeepTheFramesOfTheCutTrial) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml";
  base::write_file_atomically(protocol, short_protocol("0.2"));
  std::mt19937 random(2);
  for (int kill = 0; kill < 6; ++kill) {
    SCOPED_TRACE(kill);
    const std::string database = folder / ("kill" + std::to_string(kill) + ".db");
    const auto arguments = run_arguments(protocol, database, {"--participants", "1", "--clock", "real"});
    check_one_kill(database, arguments, static_cast<int>(random() % 6),
                   std::chrono::microseconds(random() % 200000), 6);
  }
}

TEST(StudyKillE2e, OneRunMayBeKilledAgainAndAgain) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", database = folder / "study.db";
  base::write_file_atomically(protocol, short_protocol("10"));
  run_and_kill(run_arguments(protocol, database, {"--participants", "4"}), 2, {});
  Answers before;
  for (int kill = 0; kill < 6; ++kill) {
    const Answers now = answers_in(database);
    EXPECT_GE(now.size(), before.size() + 2);
    for (const auto& [key, answer] : before) EXPECT_EQ(now.at(key), answer);
    before = now;
    run_and_kill({vip_study, "resume", "--db", database, "--events"}, 2,
                 std::chrono::microseconds(700 * kill));
  }
  EXPECT_EQ(run_program({vip_study, "resume", "--db", database}).exit_code, 0);
  EXPECT_EQ(answers_in(database).size(), 24u);
}

TEST(StudyKillE2e, InterruptStopsAtAFrameAndIsResumable) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", database = folder / "study.db";
  base::write_file_atomically(protocol, short_protocol("1"));
  Process program(run_arguments(protocol, database, {"--participants", "1", "--clock", "real"}));
  program.read_line();
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  program.send(SIGINT);
  const Ended ended = program.wait();
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, ::testing::HasSubstr("vip-study resume --db " + database));
  // Closed properly: the write-ahead log is gone.
  EXPECT_FALSE(fs::exists(database + "-wal"));
  const auto cut =
      "SELECT count(*) FROM frame JOIN presentation p USING (presentation_id) WHERE p.state = 'interrupted'";
  EXPECT_GT(count_in(database, cut), 0);
  EXPECT_EQ(run_program({vip_study, "resume", "--db", database}).exit_code, 0);
  EXPECT_EQ(answers_in(database).size(), 6u);
}

}  // namespace
}  // namespace apps::test
