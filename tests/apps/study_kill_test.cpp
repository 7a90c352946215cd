/// A run that is killed at any instant loses no answer and asks none twice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>

#include "libstudy/store/personal.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

/// Runs until `lines` units were acknowledged, waits for `delay`, then kills. Returns everything that was
/// acknowledged.
std::string run_and_kill(const std::vector<std::string>& arguments, int lines,
                         std::chrono::microseconds delay) {
  Process program(arguments);
  for (int i = 0; i < lines; ++i) program.read_line();
  std::this_thread::sleep_for(delay);
  program.send(SIGKILL);
  return program.wait().out;
}

/// Expects that everything was asked exactly once and nothing is half done.
void check_whole(const std::string& database, std::size_t answers, std::size_t units) {
  EXPECT_EQ(answers_in(database).size(), answers);
  EXPECT_EQ(done_in(database).size(), units);
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM response"), static_cast<std::int64_t>(answers));
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM event WHERE kind = 'done'"),
            static_cast<std::int64_t>(units));
  EXPECT_EQ(count_in(database, "SELECT count(*) FROM presentation WHERE state = 'running'"), 0);
  // A trial is shown again only while it has an unanswered question: its last answer belongs to its last
  // showing.
  EXPECT_EQ(count_in(database,
                     "SELECT count(*) FROM trial t WHERE (SELECT max(attempt) FROM presentation p "
                     "WHERE p.trial_id = t.trial_id) <> (SELECT max(r.attempt) FROM response r "
                     "JOIN unit u USING (unit_id) WHERE u.trial_id = t.trial_id)"),
            0);
}

/// Kills a run, resumes it, and checks every guarantee; returns the answers.
Answers check_one_kill(const std::string& database, const std::vector<std::string>& arguments, int lines,
                       std::chrono::microseconds delay, std::size_t answers, std::size_t units) {
  const std::string told = run_and_kill(arguments, lines, delay);
  const auto said = acknowledged(told);
  // Killed before the plan was stored: nothing to resume, so the same run is started again.
  if (!fs::exists(database) || count_in(database, "SELECT count(*) FROM sqlite_schema") == 0 ||
      count_in(database, "SELECT count(*) FROM trial") == 0) {
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(run_program(arguments).exit_code, 0);
    return answers_in(database);
  }
  const Answers before = answers_in(database);
  // Everything acknowledged is stored; at most one more unit was stored but not yet acknowledged.
  const Units done = done_in(database);
  for (const auto& key : said) EXPECT_TRUE(done.count(key)) << key.first << " " << key.second;
  EXPECT_LE(done.size(), said.size() + 1);

  const Ended resumed = run_program({vip_study, "resume", "--db", database, "--events"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  const Answers after = answers_in(database);
  for (const auto& [key, answer] : before) EXPECT_EQ(after.at(key), answer);
  for (const auto& key : acknowledged(resumed.out)) EXPECT_FALSE(done.count(key)) << "asked twice";
  check_whole(database, answers, units);
  return after;
}

std::map<AnswerKey, int> scores(const Answers& answers) {
  std::map<AnswerKey, int> scores;
  for (const auto& [key, answer] : answers) scores[key] = std::get<1>(answer);
  return scores;
}

std::vector<std::string> personal_in(const std::string& database) {
  study::sqlite::Connection file(study::PersonalFile::beside(database), study::sqlite::Open::Read);
  study::sqlite::Statement row(file, "SELECT participant || question || answer FROM personal ORDER BY 1");
  std::vector<std::string> all;
  while (row.step()) all.push_back(row.text(0));
  return all;
}

TEST(StudyKillE2e, TwentyInstantsOfASessionWithEveryBlock) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "blocks.toml";
  base::write_file_atomically(protocol, protocol_text("blocks"));
  const auto arguments = [&](const std::string& database) {
    return std::vector<std::string>{vip_study, "run",        protocol, "--db",   database, "--participants",
                                    "4",       "--observer", "random", "--seed", "5",      "--events"};
  };
  const std::string whole_db = folder / "whole.db";
  const Ended run = run_program(arguments(whole_db));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto whole = scores(answers_in(whole_db));
  const std::size_t units = done_in(whole_db).size();
  ASSERT_EQ(units, 4u * (4 + 1 + 6 + 1 + 2 + 1 + 2 + 1));
  ASSERT_EQ(whole.size(), 4u * (2 + 16 + 2 * 9 + 2));
  ASSERT_EQ(personal_in(whole_db).size(), 4u);

  std::mt19937 random(3);
  for (int kill = 0; kill < 20; ++kill) {
    SCOPED_TRACE(kill);
    const std::string database = folder / ("kill" + std::to_string(kill) + ".db");
    const int lines = static_cast<int>(random() % units);
    const std::chrono::microseconds delay(random() % 10000);
    EXPECT_EQ(scores(check_one_kill(database, arguments(database), lines, delay, whole.size(), units)),
              whole);
    EXPECT_EQ(personal_in(database), personal_in(whole_db));
  }
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
  ASSERT_EQ(whole.size(), 28u);  // for each of four people: six ratings and the consent

  std::mt19937 random(1);
  for (int kill = 0; kill < 14; ++kill) {
    SCOPED_TRACE(kill);
    const std::string database = folder / ("kill" + std::to_string(kill) + ".db");
    const int lines = static_cast<int>(random() % 36);
    const std::chrono::microseconds delay(random() % 20000);
    EXPECT_EQ(scores(check_one_kill(database, arguments(database), lines, delay, 28, 36)), whole);
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
    check_one_kill(database, arguments, static_cast<int>(random() % 9),
                   std::chrono::microseconds(random() % 200000), 7, 9);
  }
}

TEST(StudyKillE2e, OneRunMayBeKilledAgainAndAgain) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", database = folder / "study.db";
  base::write_file_atomically(protocol, short_protocol("10"));
  run_and_kill(run_arguments(protocol, database, {"--participants", "4"}), 4, {});
  Answers before;
  std::size_t done_before = 0;
  for (int kill = 0; kill < 6; ++kill) {
    // Units, not answers, must grow: the two units of one run may be the last page of one person and the
    // first page of the next.
    const std::size_t done = done_in(database).size();
    EXPECT_GT(done, done_before);
    const Answers now = answers_in(database);
    for (const auto& [key, answer] : before) EXPECT_EQ(now.at(key), answer);
    before = now;
    done_before = done;
    run_and_kill({vip_study, "resume", "--db", database, "--events"}, 4,
                 std::chrono::microseconds(700 * kill));
  }
  EXPECT_EQ(run_program({vip_study, "resume", "--db", database}).exit_code, 0);
  EXPECT_EQ(answers_in(database).size(), 28u);
}

TEST(StudyKillE2e, InterruptStopsAtAFrameAndIsResumable) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", database = folder / "study.db";
  base::write_file_atomically(protocol, short_protocol("1"));
  Process program(run_arguments(protocol, database, {"--participants", "1", "--clock", "real"}));
  for (int unit = 0; unit < 3; ++unit) program.read_line();  // two pages and a trial
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
  EXPECT_EQ(answers_in(database).size(), 7u);
}

}  // namespace
}  // namespace apps::test
