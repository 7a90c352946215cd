/// The console: its keys, and the text of its view.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libstudy/console/console.hpp"
#include "libstudy/console/console_screen.hpp"
#include "libstudy/console/console_text.hpp"
#include "libstudy/console/progress.hpp"
#include "stats/base/duration.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace apps {

namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A running pilot session with its store.
class ConsoleTest : public ::testing::Test {
 protected:
  ConsoleTest() : store_(folder_.path() / "s.db", study::sqlite::Open::Create) {
    store_.add_run(study::test::run_plan(protocol_, {"P01"}));
    runs_ = store_.open_runs();
    console_.begin(session());
  }

  const study::OpenSession& session() const { return runs_.at(0).sessions.at(0); }
  const study::OpenUnit& first_trial() const {
    for (const auto& unit : session().units) {
      if (unit.trial) return unit;
    }
    throw std::logic_error("no trial");
  }
  void type(const std::string& keys) {
    for (const char byte : keys) console_.key(byte);
  }
  std::string lines() {
    std::string all;
    for (const std::string& line : console_.take_lines()) all += line + "\n";
    return all;
  }
  std::int64_t count(const std::string& sql) {
    return study::sqlite::Connection(folder_.path() / "s.db", study::sqlite::Open::Read)
        .integer("SELECT count(*) FROM " + sql);
  }

  study::test::TemporaryFolder folder_;
  study::Protocol protocol_ = study::test::pilot();
  study::Store store_;
  std::vector<study::OpenRun> runs_;
  std::optional<double> idle_s_;
  study::Console console_{protocol_, store_, folder_.path() / "s.db", [this] { return idle_s_; }};
};

TEST_F(ConsoleTest, SaysThatTrackedGazeIsMissingAndNamesNoHypothesisOfAPlanThatItDoesNotKnow) {
  EXPECT_THAT(lines(), HasSubstr("gaze: none\n"));
  protocol_.needs_gaze = true;
  console_.begin(session());
  EXPECT_THAT(lines(), HasSubstr("gaze: none; hypotheses that need tracked gaze are not testable\n"));
}

TEST_F(ConsoleTest, HidesTheSettingUntilItIsRevealedAndLogsThat) {
  console_.begins(first_trial());
  study::UnitDone done{"P01", first_trial().plan, 1, {study::test::verdict()}};
  console_.done(done);
  const std::string hidden = lines();
  EXPECT_THAT(hidden, HasSubstr("timing degraded"));
  for (const char* secret : {"HiRes", "49.5", "frames/s", "one frame late"})
    EXPECT_THAT(hidden, Not(HasSubstr(secret)));
  EXPECT_EQ(count("event WHERE kind = 'setting revealed'"), 0);
  type("m");
  console_.request();
  EXPECT_EQ(count("event WHERE kind = 'setting revealed'"), 1);
  console_.begins(first_trial());
  EXPECT_THAT(lines(), HasSubstr("HiRes"));
}

TEST_F(ConsoleTest, PauseHoldsUntilItIsLifted) {
  EXPECT_EQ(console_.request(), study::Request::GoOn);
  type("p");
  EXPECT_EQ(console_.request(), study::Request::Pause);
  EXPECT_EQ(console_.request(), study::Request::Pause);
  type("p");
  EXPECT_EQ(console_.request(), study::Request::GoOn);
}

TEST_F(ConsoleTest, TroubleIsAnAlarmAndPausesUntilTheExperimenterGoesOn) {
  console_.begins(first_trial());
  console_.trouble({"the eye tracker does not see the eyes", "calibrate it"});
  EXPECT_EQ(console_.request(), study::Request::Pause);
  EXPECT_THAT(lines(),
              HasSubstr("PAUSED: the eye tracker does not see the eyes; calibrate it; then p goes on"));
  const auto alarms = console_.view(0).alarms;
  ASSERT_FALSE(alarms.empty());
  EXPECT_EQ(alarms.front(), "the eye tracker does not see the eyes; calibrate it; then p goes on");
  EXPECT_THAT(console_.view(0).person, HasSubstr("pictures cannot be shown"));
  type("p");
  EXPECT_EQ(console_.request(), study::Request::GoOn);
  EXPECT_THAT(console_.view(0).alarms, Not(::testing::Contains(HasSubstr("eye tracker"))));
}

TEST_F(ConsoleTest, TheSessionEndsOnlyOnAWholeYes) {
  for (const char* half : {"e\n", "ey\n", "eno\n", "eye\x1b", "q", "E"}) type(half);
  EXPECT_EQ(console_.request(), study::Request::GoOn);
  type("eyes\n");
  EXPECT_EQ(console_.request(), study::Request::EndSession);
}

TEST_F(ConsoleTest, ARunningTrialIsRepeatedOnce) {
  console_.begins(first_trial());
  type("r\n");
  EXPECT_EQ(console_.request(), study::Request::GoOn) << "without a reason";
  type("rdoor slammed\n");
  EXPECT_EQ(console_.request(), study::CutCause::Experimenter);
  EXPECT_EQ(console_.request(), study::Request::GoOn);
}

TEST_F(ConsoleTest, WhatIsSaidToBeDoneIsOnTheDiskAlsoWhileATrialRuns) {
  console_.begins(first_trial());
  lines();
  type("nphone rang\n");
  EXPECT_THAT(lines(), HasSubstr("noted: phone rang"));
  EXPECT_EQ(count("note WHERE words LIKE '%phone rang'"), 1);
  type("xwrong glasses\n");
  EXPECT_THAT(lines(), HasSubstr("trial 1 is excluded"));
  EXPECT_EQ(count("trial WHERE excluded = 'wrong glasses'"), 1);
  type("m");
  EXPECT_THAT(lines(), HasSubstr("revealed (logged)"));
  EXPECT_EQ(count("event WHERE kind = 'setting revealed'"), 1);
  type("rdoor slammed\n");
  EXPECT_THAT(lines(), HasSubstr("trial 1 is shown again"));
  EXPECT_EQ(count("event WHERE kind = 'trial set aside'"), 1);
}

TEST_F(ConsoleTest, WhatCannotBeKeptIsSaidNotToBe) {
  const auto path = folder_.path() / "full.db";
  study::Store(path, study::sqlite::Open::Create).add_run(study::test::run_plan(protocol_, {"P01"}));
  study::Store full(path, study::sqlite::Open::Write, 1);  // the database cannot grow by a page
  const auto runs = full.open_runs();
  study::Console console(protocol_, full, path);
  console.begin(runs.at(0).sessions.at(0));
  console.begins(runs.at(0).sessions.at(0).units.at(0));
  for (int i = 0; i < 40; ++i) {
    for (const char byte : "n" + std::string(400, 'x') + "\n") console.key(byte);
  }
  std::int64_t noted = 0, refused = 0;
  for (const std::string& line : console.take_lines()) {
    noted += line.find("noted: ") != std::string::npos ? 1 : 0;
    refused += line.find("NOT KEPT: note: xxx") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(refused, 0);
  EXPECT_EQ(noted + refused, 40);
  EXPECT_EQ(study::sqlite::Connection(path, study::sqlite::Open::Read).integer("SELECT count(*) FROM note"),
            noted);
}

TEST_F(ConsoleTest, ARepeatThatComesTooLateIsShownAtTheEnd) {
  console_.begins(first_trial());
  const int attempt = study::test::show(store_, session(), first_trial());
  type("rdoor slammed\n");
  const study::KeptAnswer kept{"satisfaction", {study::test::score(4), 1.5}};
  store_.answer(session().id, first_trial(), attempt, {&kept, 1}, true, 900);
  EXPECT_EQ(count("unit WHERE trial_id = 1 AND state = 'done'"), 0) << "that showing was set aside";
  console_.done({"P01", first_trial().plan, 1, {}});
  EXPECT_EQ(console_.request(), study::Request::GoOn);
  EXPECT_THAT(lines(), HasSubstr("trial 1 is shown again at the end of the session"));
  EXPECT_TRUE(console_.take_reopened());
}

TEST_F(ConsoleTest, AfterTheSessionKeysDoNothing) {
  EXPECT_FALSE(console_.take_reopened());
  type("ntoo late\nm");
  EXPECT_EQ(count("note"), 0);
  EXPECT_EQ(count("event WHERE kind = 'setting revealed'"), 0);
}

TEST_F(ConsoleTest, NotesAreWholeLettersOfUtf8) {
  type("na\xFFz\n");
  EXPECT_THAT(lines(), HasSubstr("not UTF-8"));
  EXPECT_EQ(count("note"), 0);
  std::string umlauts = "x";
  for (int i = 0; i < 400; ++i) umlauts += "\xC3\xBC";
  type("n" + umlauts + "\n");
  EXPECT_THAT(lines(), HasSubstr("noted: x\xC3\xBC"));
  EXPECT_EQ(count("note WHERE length(words) = 9 + 1 + 249"), 1);
}

TEST_F(ConsoleTest, ATrialIsExcludedWithItsReason) {
  type("x");
  EXPECT_THAT(lines(), HasSubstr("no trial to exclude"));
  console_.begins(first_trial());
  type("xwron\x7fng glasses\n");
  console_.done({"P01", first_trial().plan, 1, {}});
  EXPECT_EQ(count("trial WHERE excluded = 'wrong glasses'"), 1);
}

TEST_F(ConsoleTest, ViewShowsLatenessAndWhatIsTyped) {
  console_.begins(first_trial());
  for (int i = 0; i < 40; ++i) {
    study::FrameRecord frame;
    frame.index = i;
    frame.scheduled_ns = 1'000'000'000LL + i * 50'000'000LL;
    frame.times.submitted_ns = frame.scheduled_ns + (i == 20 ? 7'000'000 : 0);
    frame.late = i == 20;
    console_.shown(frame);
  }
  const study::ConsoleView view = console_.view(study::steady_ns());
  EXPECT_THAT(view.rate, HasSubstr("late 1, worst 7.00 ms"));
  EXPECT_THAT(view.rate, Not(HasSubstr("frames/s"))) << "it would tell the setting";
  EXPECT_THAT(view.strip, HasSubstr("..."));
  EXPECT_THAT(view.person, StartsWith("looks at the stimulus"));
  EXPECT_THAT(view.alarms, Contains(HasSubstr("1 late frame in this showing")));
  type("nab");
  EXPECT_EQ(console_.view(study::steady_ns()).typed, "note: ab");
}

TEST_F(ConsoleTest, ViewSaysWhatThePersonDoes) {
  const auto person = [&](double later_s = 0) {
    return console_.view(study::steady_ns() + std::llround(1e9 * later_s)).person;
  };
  EXPECT_THAT(person(), StartsWith("waits"));
  console_.begins(session().units.front());
  idle_s_ = 12;
  EXPECT_THAT(person(34),
              AllOf(StartsWith("on this page for 34 s"), HasSubstr("last key or mouse 12 s ago")));
  EXPECT_THAT(console_.view(study::steady_ns()).alarms, Not(Contains(HasSubstr("nothing was pressed"))));
  idle_s_ = 200;
  EXPECT_THAT(console_.view(study::steady_ns() + 200'000'000'000).alarms,
              Contains(HasSubstr("nothing was pressed for 3 min")));
  type("p");
  EXPECT_THAT(person(), HasSubstr("PAUSE before the next step"));
  console_.done({"P01", session().units.front().plan, 1, {}});
  EXPECT_THAT(person(), StartsWith("PAUSED"));
  type("p");
  console_.ends({study::EarlyEnd::Stopped, "sick"});
  EXPECT_THAT(person(), StartsWith("STOPPED"));
  EXPECT_THAT(console_.view(study::steady_ns()).alarms, Contains(StartsWith("STOPPED")));
  console_.ends({study::EarlyEnd::NotEligible, "age"});
  EXPECT_THAT(person(), StartsWith("INELIGIBLE"));
  console_.take_reopened();
}

TEST_F(ConsoleTest, AFailedVerdictSaysWhatToDoNextAndWarningsStay) {
  console_.begins(first_trial());
  study::TimingVerdict failed = study::test::verdict();
  failed.verdict = study::Verdict::Fail;
  console_.warn("power governor: powersave");
  console_.done({"P01", first_trial().plan, 1, {failed}});
  const study::ConsoleView view = console_.view(study::steady_ns());
  EXPECT_THAT(view.alarms, ElementsAre(HasSubstr("trial 1: timing FAILED; r shows it again"),
                                       "power governor: powersave"));
  EXPECT_THAT(view.last, HasSubstr("timing fail"));
  EXPECT_THAT(view.plan, HasSubstr("1 of "));
}

TEST_F(ConsoleTest, ATrialThatWasCutIsToldApartFromOneThatFailed) {
  console_.begins(first_trial());
  study::TimingVerdict cut = study::test::verdict();
  cut.verdict = study::Verdict::Fail;
  cut.cut = true;
  console_.done({"P01", first_trial().plan, 1, {study::test::verdict(), cut}});
  EXPECT_THAT(console_.view(study::steady_ns()).alarms, ElementsAre(HasSubstr("trial 1: CUT")));
  cut.nominal = {};
  cut.reason = "cut 20 s after its start";
  console_.done({"P01", first_trial().plan, 1, {cut}});
  EXPECT_THAT(console_.view(study::steady_ns()).last, HasSubstr("timing fail: cut 20 s"));
}

TEST(ConsoleScreen, FillsEightyByTwentyFourAndNoLineIsLonger) {
  study::ConsoleView view;
  view.title = "P01, visit 1: task1 1.0";
  view.clock = "14:03:05";
  view.done = 0.25;
  view.plan = "11 of 44 steps done; left: about 12 min";
  view.now = "step 12 of 44: stimulus 'ratings', trial 3";
  view.person = "looks at the stimulus";
  view.typed = "note: " + std::string(200, 'x') + "end";
  for (int i = 0; i < 30; ++i) view.said.push_back("said " + std::to_string(i) + std::string(100, '.'));
  for (int i = 0; i < 5; ++i) view.alarms.push_back("alarm " + std::to_string(i));
  const auto lines = study::render_console(view, 80, 24);
  ASSERT_EQ(lines.size(), 24u);
  for (const std::string& line : lines) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_EQ(lines[0], "P01, visit 1: task1 1.0" + std::string(80 - 23 - 8, ' ') + "14:03:05");
  EXPECT_EQ(lines[2], "Plan     [#####...............] 11 of 44 steps done; left: about 12 min");
  EXPECT_EQ(lines[4], "Person   looks at the stimulus");
  EXPECT_THAT(lines[9], HasSubstr(". on time  + faster  - slower  ! by over 20 %"));
  EXPECT_EQ(lines[12], "ALARMS   alarm 0");
  EXPECT_EQ(lines[14], "         3 more: alarm 2");
  EXPECT_THAT(lines[20], StartsWith("said 29"));
  EXPECT_THAT(lines[21], HasSubstr("p pause"));
  EXPECT_THAT(lines[23], EndsWith("xend"));
}

TEST(ConsoleScreen, FitsEveryTerminal) {
  study::ConsoleView view;
  view.title = view.person = "\xE4\xBD\xA0\xE5\xA5\xBD \xC3\xBC";  // two wide letters, a narrow one
  view.said = {"one", "two"};
  for (const auto& [columns, rows] : {std::pair{132, 50}, {80, 24}, {20, 10}, {2, 1}, {1, 1}}) {
    const auto lines = study::render_console(view, columns, rows);
    EXPECT_EQ(lines.size(), static_cast<std::size_t>(rows));
    for (const std::string& line : lines)
      EXPECT_LE(line.size(), static_cast<std::size_t>(2 * columns)) << "bytes; three each for two columns";
  }
  EXPECT_EQ(study::render_console(view, 14, 24)[4], "Person   \xE4\xBD\xA0...");
  EXPECT_EQ(study::render_console(view, 80, 24)[12], "Alarms   none");
}

TEST_F(ConsoleTest, TellsTheTimeLeftByWhatWasMeasured) {
  const auto left = [](const study::Console& console) { return console.view(study::steady_ns()).plan; };
  study::Console slow(protocol_, store_, folder_.path() / "s.db", {},
                      std::vector<double>(protocol_.design.cells.size(), 300));
  slow.begin(session());
  EXPECT_THAT(left(console_), AllOf(HasSubstr("about "), HasSubstr(" min")));
  EXPECT_THAT(
      left(slow),
      HasSubstr(base::duration_words(study::expected_s(
          protocol_, session().units, true, std::vector<double>(protocol_.design.cells.size(), 300)))));
  EXPECT_NE(left(slow), left(console_));
}

TEST_F(ConsoleTest, TimeLeftIsThatOfThePlan) {
  const study::OpenUnit& trial = first_trial();
  EXPECT_DOUBLE_EQ(study::expected_s(protocol_, trial), 3 + 10 + 5);  // s: black, stimulus, one question
  double sum = 0;
  for (const auto& unit : session().units) sum += study::expected_s(protocol_, unit);
  EXPECT_DOUBLE_EQ(study::expected_s(protocol_, session().units), sum);
  EXPECT_GT(sum, 21 * 18);
  EXPECT_DOUBLE_EQ(study::expected_s(protocol_, trial, false), 3 + 10) << "an observer answers at once";
  EXPECT_LT(study::expected_s(protocol_, session().units, false), sum);
  std::vector<double> showing_s(protocol_.design.cells.size(), 10);
  showing_s.at(static_cast<std::size_t>(trial.trial->first)) = 20;
  EXPECT_DOUBLE_EQ(study::expected_s(protocol_, trial, true, showing_s), 3 + 20 + 5)
      << "as it was measured here";
  EXPECT_DOUBLE_EQ(study::expected_s(protocol_, session().units, true, showing_s), sum + 10);
  // The 21 settings have 333 frames on average, estimated at 64 bytes each. The bound counts 200 frames.
  EXPECT_GT(study::expected_bytes(protocol_, session().units), 64u * 21 * 200);
}

}  // namespace

}  // namespace apps
