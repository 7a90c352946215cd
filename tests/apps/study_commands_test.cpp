/// vip-study run, resume, status and export as a user runs them: results, and errors that change nothing.
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Names and bytes of all files of a folder.
std::map<std::string, std::string> snapshot(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[entry.path().string()] = base::read_file(entry.path(), 1u << 30);
  }
  return files;
}

class StudyCommandsE2e : public ::testing::Test {
 protected:
  StudyCommandsE2e() { base::write_file_atomically(folder_ / "short.toml", short_protocol("10")); }
  Ended run(const std::vector<std::string>& more = {"--participants", "2"},
            const std::function<void()>& prepare = {}) {
    return run_program(run_arguments(folder_ / "short.toml", database_, more), prepare);
  }
  /// Expects one error with its place and remedy, and all files unchanged.
  void expect_error(const std::vector<std::string>& arguments, const std::string& problem,
                    const std::function<void()>& prepare = {}) {
    const auto before = snapshot(folder_.path());
    const Ended ended = run_program(arguments, prepare);
    EXPECT_EQ(ended.exit_code, 1) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(problem), HasSubstr("mend: ")));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 2) << ended.err;
    EXPECT_TRUE(snapshot(folder_.path()) == before) << "files changed";
  }

  TemporaryFolder folder_;
  std::string database_ = folder_ / "study.db";
};

TEST_F(StudyCommandsE2e, RunPrintsTheCertificateAndStatusTheCounts) {
  const Ended ended = run();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("Timing certificate"), HasSubstr("12 of 12 trials pass")));
  const Ended status = run_program({vip_study, "status", "--db", database_});
  EXPECT_EQ(status.exit_code, 0);
  EXPECT_THAT(status.out, AllOf(HasSubstr("12 of 12 trials answered"), HasSubstr("simulated ptpe:a=31"),
                                HasSubstr("4200 frames recorded")));
  const Ended written = run_program({vip_study, "export", "--db", database_, "--csv", folder_ / "out"});
  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("frames.csv: 4200 rows"));
}

TEST_F(StudyCommandsE2e, StatusCountsTrialsByLevelAndHasTheCertificate) {
  const std::vector<std::string> run{vip_study,
                                     "run",
                                     "hitch_quest",
                                     "--db",
                                     database_,
                                     "--participants",
                                     "1",
                                     "--observer",
                                     "detect:hitch_ms,threshold=80",
                                     "--trial-seconds",
                                     "2"};
  const Ended ended = run_program(run);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\nhitch  asked "));
  const Ended status = run_program({vip_study, "status", "--db", database_});
  EXPECT_EQ(status.exit_code, 0) << status.err;
  EXPECT_THAT(status.out, HasSubstr("\n  hitch: h17 ")) << "levels are chosen later: no planned numbers";
  EXPECT_THAT(status.out,
              AllOf(HasSubstr(", h50 "), HasSubstr("\nhitch  asked "), HasSubstr(" hitch of 50 ms")));
}

TEST_F(StudyCommandsE2e, ARunInRealTimeSaysHowLongBeforeItStarts) {
  Process process(run_arguments(folder_ / "short.toml", database_,
                                {"--participants", "40", "--clock", "real", "--display", "none"}));
  ASSERT_TRUE(process.read_line());  // from --events: the first step starts
  process.send(SIGINT);
  const Ended ended = process.wait();
  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  EXPECT_THAT(ended.err, ::testing::StartsWith("short: 40 sessions in real time, about 43 min\n"));
  EXPECT_THAT(run({"--participant", "P41"}).err, ::testing::Not(HasSubstr("real time")));
}

TEST_F(StudyCommandsE2e, AMirrorNeedsAWindow) {
  expect_error(run_arguments(folder_ / "short.toml", database_, {"--participant", "P01", "--mirror"}),
               "--mirror: there is no participant's window");
}

TEST_F(StudyCommandsE2e, ShortenedTrialsAreTestData) {
  ASSERT_EQ(run({"--participants", "1", "--trial-seconds", "2"}).exit_code, 0);
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM session WHERE test_data = 1"), 1);
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM frame"), 3 * 40 + 3 * 100);
}

TEST_F(StudyCommandsE2e, ParticipantsWhoAreDoneAreNotTakenTwice) {
  ASSERT_EQ(run().exit_code, 0);
  expect_error(run_arguments(folder_ / "short.toml", database_, {"--participant", "P02"}),
               "it is over (done)");
  EXPECT_EQ(run({"--participant", "P03"}).exit_code, 0);
}

TEST_F(StudyCommandsE2e, CodesAndStationsAreWhatFilesAndPeopleCanTell) {
  ASSERT_EQ(run({"--participant", "P01", "--station", "Labor Z\xC3\xBCrich"}).exit_code, 0);
  for (const std::string code : {"-1-2", "--yes", "-rf", "_x"})
    expect_error(run_arguments(folder_ / "short.toml", database_, {"--participant=" + code}),
                 "participant '" + code + "': is not a participant code");
  expect_error(run_arguments(folder_ / "short.toml", database_, {"--participant", "p01"}),
               "differs from P01 only in case, punctuation or leading zeros");
  for (const std::string& station : {std::string(101, 'x'), std::string("lab\xFF"), std::string("lab\n1")}) {
    const Ended ended = run({"--participant", "P02", "--station", station});
    EXPECT_EQ(ended.exit_code, 2) << station;
  }
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM session"), 1);
}

TEST_F(StudyCommandsE2e, BothTasksRunAndEachParticipantTakesAnotherSlot) {
  for (const std::string task : {"task1", "task2"}) {
    SCOPED_TRACE(task);
    const std::string database = folder_ / (task + ".db");
    const std::string protocol = base::resource("protocols/" + task + ".toml").string();
    const auto run = [&](const std::string& code) {
      return run_program({vip_study, "run", protocol, "--db", database, "--participant", code, "--observer",
                          "frames", "--station", "north"});
    };
    for (const char* code : {"P1", "P2"}) {
      const Ended ended = run(code);
      ASSERT_EQ(ended.exit_code, 0) << ended.err;
    }
    EXPECT_EQ(count_in(database, "SELECT count(DISTINCT slot) FROM session WHERE state = 'done'"), 2);
    EXPECT_EQ(
        count_in(database, "SELECT count(*) FROM session WHERE station = 'north' AND gaze_source = 'none'"),
        2);
    // Ten reports of five answers, or ten choices, and two boxes of consent.
    EXPECT_EQ(count_in(database, "SELECT count(*) FROM response"), 2 * ((task == "task1" ? 50 : 10) + 2));
    EXPECT_EQ(count_in(database, "SELECT count(*) FROM presentation WHERE verdict = 'pass'"),
              2 * (task == "task1" ? 10 : 20));
  }
}

TEST_F(StudyCommandsE2e, APersonNeedsANameAWindowAndRealTime) {
  const auto asks = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{vip_study, "run", folder_ / "short.toml", "--db", database_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  expect_error(asks({}), "--participant: is missing");
  expect_error(asks({"--participant", "P1", "--display", "none"}), "shows nothing to a person");
  expect_error(asks({"--participant", "P1", "--clock", "virtual"}), "does not wait for a person");
  expect_error(asks({"--observer", "random", "--gaze", "mouse"}), "needs a window");
  expect_error(asks({"--participant", "P1", "--gaze", "tracked"}), "needs an eye tracker");
  expect_error(asks({"--observer", "random", "--screen-width-mm", "500"}), "are needed together");
  expect_error(asks({"--observer", "nobody"}), "is not a kind of observer");
}

TEST_F(StudyCommandsE2e, WrongInputMakesNoDatabase) {
  const auto arguments = [&](const std::vector<std::string>& more) {
    return run_arguments(folder_ / "short.toml", database_, more);
  };
  expect_error(arguments({"--participant", "Anna Berg"}), "participant 'Anna Berg'");
  expect_error(arguments({"--participant", "P1", "--participant", "P1"}), "participant P1");
  expect_error(arguments({"--stimulus", folder_ / "none.bake"}), "none.bake");
  expect_error(arguments({"--trial-seconds", "0"}), "trial");
  expect_error(arguments({"--ptpe", folder_ / "none.toml"}), "none.toml");
  expect_error({vip_study, "run", folder_ / "short.toml", "--db", database_, "--observer", "ptpe:a=31,x=1"},
               "character 11: unknown key 'x'");
  base::write_file_atomically(folder_ / "short.toml", short_protocol("10") + "\n[extra]\nkey = 1\n");
  expect_error(arguments({}), "short.toml:");
}

TEST_F(StudyCommandsE2e, ForeignNewerAndTruncatedDatabasesAreLeftAlone) {
  ASSERT_EQ(run().exit_code, 0);
  const std::string whole = base::read_file(database_, 1u << 30);
  std::string newer = whole;
  newer[63] = 99;  // user_version in the header of an SQLite file
  const std::map<std::string, std::string> bad{{"newer program", newer},
                                               {"damaged or cut short", whole.substr(0, whole.size() / 2)},
                                               {"is not a database of vip-study", std::string(9000, 'x')}};
  for (const auto& [problem, bytes] : bad) {
    SCOPED_TRACE(problem);
    base::write_file_atomically(database_, bytes);
    expect_error({vip_study, "resume", "--db", database_}, problem);
    expect_error({vip_study, "status", "--db", database_}, problem);
    expect_error({vip_study, "export", "--db", database_, "--csv", folder_ / "out"}, problem);
    expect_error(run_arguments(folder_ / "short.toml", database_, {"--participant", "P09"}), problem);
  }
  fs::remove(database_);
  expect_error({vip_study, "resume", "--db", database_}, "there is no such database");
}

TEST_F(StudyCommandsE2e, FullAtThePlanLeavesNoFile) {
  expect_error(run_arguments(folder_ / "short.toml", database_, {"--max-pages", "5"}), "no room left");
  expect_error(
      run_arguments(folder_ / "short.toml", database_, {"--participants", "999", "--max-pages", "40"}),
      "no room left");
}

TEST_F(StudyCommandsE2e, FullInTheMiddleKeepsEveryAnswer) {
  const Ended full = run({"--participants", "4", "--max-pages", "96"});
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.err, AllOf(HasSubstr("no room left"), HasSubstr("vip-study resume")));
  const auto said = acknowledged(full.out);
  const Answers before = answers_in(database_);
  EXPECT_GT(said.size(), 9u);
  EXPECT_EQ(done_in(database_), Units(said.begin(), said.end()));
  EXPECT_EQ(run_program({vip_study, "resume", "--db", database_}).exit_code, 0);
  const Answers after = answers_in(database_);
  EXPECT_EQ(after.size(), 28u);  // for each of four people: six ratings and the consent
  for (const auto& [key, answer] : before) EXPECT_EQ(after.at(key), answer);
}

TEST_F(StudyCommandsE2e, AFileSizeLimitKeepsEveryAnswer) {
  const auto limit = [] {
    const rlimit bytes{300'000, 300'000};
    ::setrlimit(RLIMIT_FSIZE, &bytes);
  };
  const Ended full = run({"--participants", "4"}, limit);
  EXPECT_EQ(full.exit_code, 1) << full.signal;
  EXPECT_THAT(full.err, AllOf(HasSubstr(database_), HasSubstr("mend: ")));
  const auto said = acknowledged(full.out);
  EXPECT_GT(said.size(), 0u);
  EXPECT_EQ(run_program({vip_study, "resume", "--db", database_}).exit_code, 0);
  EXPECT_EQ(answers_in(database_).size(), 28u);
  for (const auto& key : said) EXPECT_TRUE(done_in(database_).count(key));
}

TEST_F(StudyCommandsE2e, AReadOnlyFolderIsAnErrorForAnUnprivilegedUserAndStillReadable) {
  ASSERT_EQ(run().exit_code, 0);
  const auto become_nobody = [] {
    constexpr unsigned nobody = 65534;
    if (::geteuid() == 0 &&
        (::setgroups(0, nullptr) != 0 || ::setgid(nobody) != 0 || ::setuid(nobody) != 0)) {
      ::_exit(125);
    }
  };
  fs::permissions(folder_.path(), fs::perms(0555));
  expect_error(run_arguments(folder_ / "short.toml", folder_ / "new.db", {}), "new.db", become_nobody);
  // By default only the owner may read the database and its journal. A user who may not read the journal
  // cannot know who withdrew.
  fs::permissions(database_, fs::perms(0444));
  expect_error({vip_study, "status", "--db", database_}, "study.db.answers.jsonl: cannot be read",
               become_nobody);
  fs::permissions(database_ + ".answers.jsonl", fs::perms(0444));
  expect_error({vip_study, "resume", "--db", database_}, "study.db", become_nobody);
  const std::vector<std::string> into{vip_study, "export", "--db", database_, "--csv"};
  const auto to = [&into](const std::string& out) {
    auto all = into;
    all.push_back(out);
    return all;
  };
  expect_error(to(folder_ / "out"), "out: cannot be created", become_nobody);
  const TemporaryFolder open;
  fs::permissions(open.path(), fs::perms(0777));
  expect_error(to(open / "out"), "registered in it", become_nobody);
  const auto before = snapshot(folder_.path());
  EXPECT_EQ(run_program({vip_study, "status", "--db", database_}, become_nobody).exit_code, 0);
  EXPECT_TRUE(snapshot(folder_.path()) == before);
}

TEST_F(StudyCommandsE2e, AnObserversScoreBeyondTheScaleIsRefusedOrNamed) {
  const auto with = [&](const char* observer) {
    return run_program({vip_study, "run", folder_ / "short.toml", "--db", folder_ / "constant.db",
                        "--participants", "1", "--observer", observer, "--display", "none", "--clock",
                        "virtual"});
  };
  for (const char* observer : {"constant:99", "dropout:0.1,constant:99"}) {
    const Ended refused = with(observer);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err,
                HasSubstr("which no question of protocol 'short' takes: question 'satisfaction' goes "
                          "from 1 to 7"));
    EXPECT_FALSE(fs::exists(folder_ / "constant.db"));
  }
  const Ended inside = with("constant:7");
  EXPECT_EQ(inside.exit_code, 0) << inside.err;
  EXPECT_EQ(inside.err, "");
}

TEST_F(StudyCommandsE2e, ExportDoesNotOverwriteForeignFiles) {
  ASSERT_EQ(run().exit_code, 0);
  fs::create_directory(folder_ / "mine");
  base::write_file_atomically(folder_ / "mine/notes.txt", "keep");
  expect_error({vip_study, "export", "--db", database_, "--csv", folder_ / "mine"},
               "is not an earlier export");
}

}  // namespace
}  // namespace apps::test
