/// The experimenter's desk: measured refresh, pre-flight list, time left, console.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "apps/study/desk/certificate.hpp"
#include "apps/study/desk/console.hpp"
#include "apps/study/desk/console_screen.hpp"
#include "apps/study/desk/console_text.hpp"
#include "apps/study/desk/preflight.hpp"
#include "apps/study/desk/progress.hpp"
#include "apps/study/desk/refresh.hpp"
#include "apps/study/desk/words.hpp"
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

/// Returns of swaps on a screen of this period, in the order of `skips` (periods to the next return).
std::vector<std::int64_t> swaps(double period_ns, int count, double jitter_ns = 0, int missed = -1) {
  std::vector<std::int64_t> out;
  double at = 1e9;
  for (int i = 0; i < count; ++i) {
    out.push_back(std::llround(at + jitter_ns * std::sin(7.0 * i)));
    at += i == missed ? 2 * period_ns : period_ns;
  }
  return out;
}

TEST(Refresh, IsMeasuredWithJitterAndMissedBeats) {
  const double period_ns = 1e9 / 59.951;
  const auto found = judge_swaps(swaps(period_ns, 120, 2e5, 40), 60);
  ASSERT_TRUE(found.in_effect);
  EXPECT_NEAR(found.period_ns, period_ns, 1e-4 * period_ns);
  EXPECT_EQ(found.nominal_hz, 60) << "59.95 is what the system calls 60";
}

/// A cell of four trials of which so many were degraded and failed.
study::CertificateRow cell_with(std::int64_t degraded, std::int64_t fail) {
  study::CertificateRow row;
  row.nominal = {50, 5, 10};
  row.trials = 4;
  row.mean = 49.5;
  row.degraded = degraded;
  row.fail = fail;
  row.pass = 4 - degraded - fail;
  row.grades = "D";
  return row;
}

TEST(Certificate, MarksCellsThatFailedByAWord) {
  const auto text = format_certificate({cell_with(0, 0), cell_with(1, 0), cell_with(2, 1)},
                                       study::FpsMean::Harmonic, false);
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_THAT(lines[0], HasSubstr("harmonic mean"));
  EXPECT_THAT(lines[2], AllOf(Not(HasSubstr("FAIL")), Not(HasSubstr("DEGRADED"))));
  EXPECT_THAT(lines[3], AllOf(HasSubstr("DEGRADED"), Not(HasSubstr("FAIL"))));
  EXPECT_THAT(lines[4], HasSubstr("FAIL"));
  EXPECT_EQ(lines[5], "8 of 12 trials pass, 1 FAIL");
  EXPECT_THAT(text, Not(HasSubstr("\033"))) << "colour where there is no terminal";
}

TEST(Certificate, IsRedOnATerminalWhereATrialFailed) {
  const auto coloured = [](const study::CertificateRow& row) {
    return format_certificate({row}, study::FpsMean::Harmonic, true);
  };
  EXPECT_THAT(coloured(cell_with(0, 0)), Not(HasSubstr("\033")));
  EXPECT_THAT(coloured(cell_with(1, 0)), AllOf(HasSubstr("\033[33m"), Not(HasSubstr("\033[31m"))));
  EXPECT_THAT(coloured(cell_with(1, 1)), AllOf(HasSubstr("\033[31m"), HasSubstr("FAIL\033[0m\n")));
}

TEST(Refresh, AToldRateThatIsWrongIsNotBelieved) {
  const auto found = judge_swaps(swaps(1e9 / 144, 120), 60);
  ASSERT_TRUE(found.in_effect);
  EXPECT_NEAR(found.nominal_hz, 144, 0.01);
}

TEST(Refresh, SwapsThatDoNotWaitAreSeen) {
  EXPECT_FALSE(judge_swaps(swaps(3e5, 120), 60).in_effect);       // 0.3 ms: at once
  EXPECT_FALSE(judge_swaps(swaps(8e6, 120, 3e6), 60).in_effect);  // as long as drawing takes
  EXPECT_FALSE(judge_swaps(swaps(1e9 / 60, 5), 60).in_effect);    // too few
  EXPECT_EQ(judge_swaps(swaps(3e5, 120), 60).nominal_hz, 0);
}

TEST(Refresh, ABeatIsWhereTheEarliestSwapsCameBack) {
  // Beats at 20, 36, 52, 68, 100 ms; one came back on time, one beat was missed.
  const std::vector<std::int64_t> late{20'300'000, 36'000'000, 52'900'000, 68'200'000, 100'500'000};
  EXPECT_EQ(beat_of(late, 16e6), 100'000'000);
}

TEST(Refresh, SchedulesBeginBetweenTwoBeats) {
  MeasuredRefresh refresh;
  refresh.in_effect = true;
  refresh.period_ns = 16e6;
  refresh.beat_ns = 1'000'000'000;
  for (const std::int64_t earliest : {1'000'000'000LL, 1'007'999'999LL, 1'008'000'001LL, 5'000'000'003LL}) {
    const std::int64_t at = between_beats(refresh, earliest);
    EXPECT_GE(at, earliest);
    EXPECT_LT(at, earliest + 16'000'000);
    EXPECT_EQ((at - refresh.beat_ns) % 16'000'000, 8'000'000);
    EXPECT_EQ(next_beat(refresh, at), at + 8'000'000);
  }
  EXPECT_EQ(between_beats({}, 12345), 12345);
  EXPECT_EQ(next_beat({}, 12345), -1);
}

Readiness of(const std::vector<PreflightLine>& lines, const std::string& what) {
  for (const PreflightLine& line : lines) {
    if (line.what == what) return line.readiness;
  }
  ADD_FAILURE() << "no line about " << what;
  return Readiness::Unknown;
}

TEST(Preflight, AGoodStationIsOk) {
  ScreenFacts screen{60, 59.95, false, false};
  StationFacts station;
  station.governors = {"performance"};
  station.free_disk_bytes = 50'000'000'000;
  station.gpu_clock_mhz = 1500;
  station.gpu_max_mhz = 1900;
  station.on_battery = false;
  const auto lines = judge_preflight(screen, station, 1'000'000);
  for (const char* what : {"refresh rate", "compositor", "power governor", "free disk", "GPU clock", "power"})
    EXPECT_EQ(of(lines, what), Readiness::Ok) << what;
}

TEST(Preflight, WhatSpoilsTimingIsWarnedOf) {
  ScreenFacts screen{60, 0, true, true};
  StationFacts station;
  station.governors = {"performance", "powersave"};
  station.free_disk_bytes = 9'000'000;
  station.on_battery = true;
  const auto lines = judge_preflight(screen, station, 1'000'000);
  for (const char* what : {"refresh rate", "compositor", "power governor", "free disk", "graphics", "power"})
    EXPECT_EQ(of(lines, what), Readiness::Warn) << what;
  screen.measured_hz = 75;
  EXPECT_EQ(of(judge_preflight(screen, station, 1), "refresh rate"), Readiness::Warn);
}

TEST(Preflight, WhatIsNotToldIsUnknown) {
  const auto lines = judge_preflight({}, {}, 1);
  for (const PreflightLine& line : lines) EXPECT_EQ(line.readiness, Readiness::Unknown) << line.what;
  EXPECT_THAT(format_preflight(lines), HasSubstr("unknown  power governor"));
}

TEST(Words, UnknownLanguagesAreEnglish) {
  EXPECT_EQ(desk_words("de-AT").go_on, "Weiter");
  EXPECT_EQ(desk_words("tlh").go_on, "Continue");
}

TEST(Words, NothingIsLeftUnsaidInAnyLanguage) {
  using study::Notice;
  using study::Offer;
  for (const char* language : {"en", "de"}) {
    const DeskWords& words = desk_words(language);
    for (const std::string& one :
         {words.go_on, words.confirm, words.finish, words.rest, words.pause, words.ready, words.first,
          words.second, words.held_title, words.held, words.corner, words.begin})
      EXPECT_FALSE(one.empty()) << language;
    for (const Notice notice : {Notice::Over, Notice::Refused, Notice::NotEligible, Notice::Kept,
                                Notice::Deleted, Notice::Goodbye}) {
      const DeskPage& page = words.page(notice);
      for (const std::string& one : {page.title, page.text, page.button})
        EXPECT_FALSE(one.empty()) << language;
      EXPECT_EQ(page.button == words.finish, notice != Notice::Over) << "the last page says so";
    }
    for (const Offer offer : {Offer::StayOut, Offer::Questionnaire, Offer::Keep}) {
      const DeskChoice& choice = words.choice(offer);
      for (const std::string& one : {choice.title, choice.text, choice.question, choice.first, choice.second})
        EXPECT_FALSE(one.empty()) << language;
    }
    EXPECT_THAT(words.begin, HasSubstr("Esc"));
    EXPECT_THAT(words.corner, HasSubstr("Esc"));
  }
  EXPECT_NE(desk_words("de").over.text, desk_words("en").over.text);
}

TEST(Strip, SignsFollowTheRate) {
  EXPECT_EQ(strip_sign(1, 1.01), '.');
  EXPECT_EQ(strip_sign(1, 1.1), '+');
  EXPECT_EQ(strip_sign(1.1, 1), '-');
  EXPECT_EQ(strip_sign(1.5, 1), '!');
  EXPECT_EQ(strip_sign(0, 1), '!');
}

/// A pilot session under way, with the store that keeps it.
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
  Console console_{protocol_, store_, folder_.path() / "s.db", [this] { return idle_s_; }};
};

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
  console_.wish();
  EXPECT_EQ(count("event WHERE kind = 'setting revealed'"), 1);
  console_.begins(first_trial());
  EXPECT_THAT(lines(), HasSubstr("HiRes"));
}

TEST_F(ConsoleTest, PauseHoldsUntilItIsLifted) {
  EXPECT_EQ(console_.wish(), study::Wish::GoOn);
  type("p");
  EXPECT_EQ(console_.wish(), study::Wish::Pause);
  EXPECT_EQ(console_.wish(), study::Wish::Pause);
  type("p");
  EXPECT_EQ(console_.wish(), study::Wish::GoOn);
}

TEST_F(ConsoleTest, TheSessionEndsOnlyOnAWholeYes) {
  for (const char* half : {"e\n", "ey\n", "eno\n", "eye\x1b", "q", "E"}) type(half);
  EXPECT_EQ(console_.wish(), study::Wish::GoOn);
  type("eyes\n");
  EXPECT_EQ(console_.wish(), study::Wish::EndSession);
}

TEST_F(ConsoleTest, ARunningTrialIsRepeatedOnce) {
  console_.begins(first_trial());
  type("r\n");
  EXPECT_EQ(console_.wish(), study::Wish::GoOn) << "without a reason";
  type("rdoor slammed\n");
  EXPECT_EQ(console_.wish(), study::Wish::RepeatTrial);
  EXPECT_EQ(console_.wish(), study::Wish::GoOn);
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
  study::Store full(path, study::sqlite::Open::Write, 1);  // no page more than it has
  const auto runs = full.open_runs();
  Console console(protocol_, full, path);
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
  EXPECT_EQ(console_.wish(), study::Wish::GoOn);
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
  const ConsoleView view = console_.view(steady_ns());
  EXPECT_THAT(view.rate, HasSubstr("late 1, worst 7.00 ms"));
  EXPECT_THAT(view.rate, Not(HasSubstr("frames/s"))) << "it would tell the setting";
  EXPECT_THAT(view.strip, HasSubstr("..."));
  EXPECT_THAT(view.person, StartsWith("looks at the stimulus"));
  EXPECT_THAT(view.alarms, Contains(HasSubstr("1 late frame in this showing")));
  type("nab");
  EXPECT_EQ(console_.view(steady_ns()).typed, "note: ab");
}

TEST_F(ConsoleTest, ViewSaysWhatThePersonDoes) {
  const auto person = [&](double later_s = 0) {
    return console_.view(steady_ns() + std::llround(1e9 * later_s)).person;
  };
  EXPECT_THAT(person(), StartsWith("waits"));
  console_.begins(session().units.front());
  idle_s_ = 12;
  EXPECT_THAT(person(34),
              AllOf(StartsWith("on this page for 34 s"), HasSubstr("last key or mouse 12 s ago")));
  EXPECT_THAT(console_.view(steady_ns()).alarms, Not(Contains(HasSubstr("nothing was pressed"))));
  idle_s_ = 200;
  EXPECT_THAT(console_.view(steady_ns() + 200'000'000'000).alarms,
              Contains(HasSubstr("nothing was pressed for 3 min")));
  type("p");
  EXPECT_THAT(person(), HasSubstr("PAUSE before the next step"));
  console_.done({"P01", session().units.front().plan, 1, {}});
  EXPECT_THAT(person(), StartsWith("PAUSED"));
  type("p");
  console_.ends({study::EarlyEnd::Stopped, "sick"});
  EXPECT_THAT(person(), StartsWith("STOPPED"));
  EXPECT_THAT(console_.view(steady_ns()).alarms, Contains(StartsWith("STOPPED")));
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
  const ConsoleView view = console_.view(steady_ns());
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
  EXPECT_THAT(console_.view(steady_ns()).alarms, ElementsAre(HasSubstr("trial 1: CUT")));
  cut.nominal = {};
  cut.reason = "cut 20 s after its start";
  console_.done({"P01", first_trial().plan, 1, {cut}});
  EXPECT_THAT(console_.view(steady_ns()).last, HasSubstr("timing fail: cut 20 s"));
}

TEST(ConsoleScreen, FillsEightyByTwentyFourAndNoLineIsLonger) {
  ConsoleView view;
  view.title = "P01, visit 1: task1 1.0";
  view.clock = "14:03:05";
  view.done = 0.25;
  view.plan = "11 of 44 steps done; left: about 12 min";
  view.now = "step 12 of 44: stimulus 'ratings', trial 3";
  view.person = "looks at the stimulus";
  view.typed = "note: " + std::string(200, 'x') + "end";
  for (int i = 0; i < 30; ++i) view.said.push_back("said " + std::to_string(i) + std::string(100, '.'));
  for (int i = 0; i < 5; ++i) view.alarms.push_back("alarm " + std::to_string(i));
  const auto lines = render_console(view, 80, 24);
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
  ConsoleView view;
  view.title = view.person = "\xE4\xBD\xA0\xE5\xA5\xBD \xC3\xBC";  // two wide letters, a narrow one
  view.said = {"one", "two"};
  for (const auto& [columns, rows] : {std::pair{132, 50}, {80, 24}, {20, 10}, {2, 1}, {1, 1}}) {
    const auto lines = render_console(view, columns, rows);
    EXPECT_EQ(lines.size(), static_cast<std::size_t>(rows));
    for (const std::string& line : lines)
      EXPECT_LE(line.size(), static_cast<std::size_t>(2 * columns)) << "bytes; three each for two columns";
  }
  EXPECT_EQ(render_console(view, 14, 24)[4], "Person   \xE4\xBD\xA0...");
  EXPECT_EQ(render_console(view, 80, 24)[12], "Alarms   none");
}

TEST_F(ConsoleTest, TellsTheTimeLeftByWhatWasMeasured) {
  const auto left = [](const Console& console) { return console.view(steady_ns()).plan; };
  Console slow(protocol_, store_, folder_.path() / "s.db", {},
               std::vector<double>(protocol_.design.cells.size(), 300));
  slow.begin(session());
  EXPECT_THAT(left(console_), AllOf(HasSubstr("about "), HasSubstr(" min")));
  EXPECT_THAT(
      left(slow),
      HasSubstr(base::duration_words(expected_s(protocol_, session().units, true,
                                                std::vector<double>(protocol_.design.cells.size(), 300)))));
  EXPECT_NE(left(slow), left(console_));
}

TEST_F(ConsoleTest, TimeLeftIsThatOfThePlan) {
  const study::OpenUnit& trial = first_trial();
  EXPECT_DOUBLE_EQ(expected_s(protocol_, trial), 3 + 10 + 5);  // black 3, stimulus 10, one question
  double sum = 0;
  for (const auto& unit : session().units) sum += expected_s(protocol_, unit);
  EXPECT_DOUBLE_EQ(expected_s(protocol_, session().units), sum);
  EXPECT_GT(sum, 21 * 18);
  EXPECT_DOUBLE_EQ(expected_s(protocol_, trial, false), 3 + 10) << "an observer answers at once";
  EXPECT_LT(expected_s(protocol_, session().units, false), sum);
  std::vector<double> showing_s(protocol_.design.cells.size(), 10);
  showing_s.at(static_cast<std::size_t>(trial.trial->first)) = 20;
  EXPECT_DOUBLE_EQ(expected_s(protocol_, trial, true, showing_s), 3 + 20 + 5) << "as it was measured here";
  EXPECT_DOUBLE_EQ(expected_s(protocol_, session().units, true, showing_s), sum + 10);
  // 21 settings of 10 s with a mean of 26.67 frames/s.
  EXPECT_GT(expected_bytes(protocol_, session().units), 64u * 21 * 200);
}

}  // namespace

}  // namespace apps
