/// The experimenter's console in a terminal, and sessions whose terminal or reader disappears.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/pseudo_terminal.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

class ConsoleE2e : public ::testing::Test {
 protected:
  ConsoleE2e() { base::write_file_atomically(protocol_, short_protocol("30")); }
  /// Arguments of a session in real time whose first trial takes half a minute.
  std::vector<std::string> arguments() const {
    return run_arguments(protocol_, database_, {"--participants", "1", "--clock", "real", "--console"});
  }
  std::int64_t count(const std::string& sql) { return count_in(database_, "SELECT count(*) FROM " + sql); }
  /// Expects the database after a requested stop: the write-ahead log is merged into it, and the trial that
  /// was cut is marked as interrupted.
  void expect_in_order() {
    EXPECT_FALSE(fs::exists(database_ + "-wal"));
    EXPECT_EQ(count("presentation WHERE state = 'running'"), 0);
    EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), 1);
    EXPECT_GT(count("frame"), 0);
  }

  TemporaryFolder folder_;
  std::string protocol_ = folder_ / "short.toml", database_ = folder_ / "study.db";
};

TEST_F(ConsoleE2e, WhatItSaysIsDoneSurvivesAKillDuringTheTrial) {
  PseudoTerminal terminal(arguments());
  ASSERT_TRUE(terminal.wait_for("trial 1;")) << terminal.seen();
  ASSERT_TRUE(terminal.wait_for("rate ")) << "frames are shown";
  terminal.type("nphone rang\nxwrong glasses\nm");
  ASSERT_TRUE(terminal.wait_for("noted: phone rang"));
  ASSERT_TRUE(terminal.wait_for("trial 1 is excluded"));
  ASSERT_TRUE(terminal.wait_for("revealed (logged)"));
  terminal.type("rdoor slammed\n");
  ASSERT_TRUE(terminal.wait_for("trial 1 is shown again"));
  terminal.send(SIGKILL);
  EXPECT_EQ(WTERMSIG(terminal.wait()), SIGKILL);
  EXPECT_EQ(count("note WHERE words LIKE '%phone rang'"), 1);
  EXPECT_EQ(count("note WHERE words = 'door slammed'"), 1);
  EXPECT_EQ(count("trial WHERE position = 0 AND excluded = 'wrong glasses'"), 1);
  EXPECT_EQ(count("trial WHERE position = 0 AND set_aside >= 1"), 1);
  EXPECT_EQ(count("event WHERE kind = 'setting revealed'"), 1);
}

TEST_F(ConsoleE2e, AClosedTerminalEndsTheSessionInOrder) {
  PseudoTerminal terminal(arguments());
  ASSERT_TRUE(terminal.wait_for("rate ")) << terminal.seen();
  terminal.type("nphone rang\n");
  ASSERT_TRUE(terminal.wait_for("noted: phone rang"));
  terminal.hang_up();
  const int status = terminal.wait();
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(count("note WHERE words LIKE '%phone rang'"), 1);
  expect_in_order();
}

TEST_F(ConsoleE2e, SignalsOfALostTerminalOrReaderEndTheSessionInOrder) {
  for (const int signal : {SIGHUP, SIGPIPE}) {
    SCOPED_TRACE(signal);
    database_ = folder_ / (std::to_string(signal) + ".db");
    PseudoTerminal terminal(arguments());
    ASSERT_TRUE(terminal.wait_for("rate ")) << terminal.seen();
    terminal.send(signal);
    EXPECT_TRUE(terminal.wait_for("vip-study resume --db " + database_)) << terminal.seen();
    const int status = terminal.wait();
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << status;
    expect_in_order();
  }
}

TEST_F(ConsoleE2e, AReaderThatLeavesEndsTheSessionInOrder) {
  base::write_file_atomically(protocol_, short_protocol("1"));
  Process program(run_arguments(protocol_, database_, {"--participants", "1", "--clock", "real"}));
  ASSERT_TRUE(program.read_line());
  program.stop_reading();
  const Ended ended = program.wait();
  EXPECT_EQ(ended.exit_code, 1) << "ended by signal " << ended.signal;
  EXPECT_THAT(ended.err, ::testing::HasSubstr("vip-study resume --db " + database_));
  EXPECT_FALSE(fs::exists(database_ + "-wal"));
  EXPECT_EQ(run_program({vip_study, "resume", "--db", database_}).exit_code, 0);
  EXPECT_EQ(answers_in(database_).size(), 7u);
}

}  // namespace
}  // namespace apps::test
