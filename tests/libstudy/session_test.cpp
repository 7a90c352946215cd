#include "libstudy/session/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "libstudy/display/null.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/session/frame_journal.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/libstudy/session_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using test::Desk;
using test::OneSession;
using test::paced_pairs;
using test::ptpe_observer;

/// One process's part of a study: plays open sessions, and stops after `frames` frames.
void play(Store& store, const Protocol& protocol, std::int64_t frames) {
  Desk desk(protocol);
  const auto observer = ptpe_observer();
  SessionHooks hooks;
  hooks.shown = [&](const FrameRecord&) { --frames; };
  hooks.request = [&] { return frames <= 0 ? Request::Stop : Request::GoOn; };
  for (const OpenRun& run : store.open_runs()) {
    for (const OpenSession& session : run.sessions)
      run_session(protocol, session, desk.parts(*observer, store), hooks);
  }
}

constexpr std::int64_t no_limit = 1'000'000'000;

/// Participant, position, score and realised moments of every trial.
auto answers(const std::filesystem::path& path) {
  std::vector<std::tuple<std::string, int, int, double, double>> rows;
  for (const test::TrialOf& row : test::trials_of(path)) {
    const auto& realised = row.trial.first.realised;  // 0 where nothing was shown
    rows.emplace_back(row.participant, row.trial.position, row.score().value_or(0), realised.mean,
                      realised.sd);
  }
  return rows;
}

TEST(Session, PlaysThePlanAndTheRealisedMomentsAreTheNominalOnes) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  Store store(folder / "study.db", Open::Create);
  const auto run = store.add_run(test::run_plan(protocol, {"P01"}));
  play(store, protocol, no_limit);
  for (const test::TrialOf& row : test::trials_of(folder / "study.db")) {
    const TaskShowing& shown = row.trial.first;
    ASSERT_TRUE(row.score());
    EXPECT_EQ(shown.verdict, Verdict::Pass) << shown.reason;
    EXPECT_NEAR(shown.realised.mean, shown.nominal.mean, 1e-6 * shown.nominal.mean);
    EXPECT_NEAR(shown.realised.sd, shown.nominal.sd, 1e-6 * shown.nominal.mean);
    EXPECT_EQ(static_cast<std::int64_t>(shown.realised.frames), frame_count(shown.nominal));
  }
  const auto certificate = read_certificate(folder / "study.db", run, FpsMean::Harmonic);
  ASSERT_EQ(certificate.size(), 21u);
  for (const CertificateRow& row : certificate) EXPECT_EQ(row.pass, 1);
  const StudyStatus status = read_status(folder / "study.db");
  EXPECT_EQ(status.frames, 7000);  // 10 s each: 2 settings of 10 frames/s, 4 of 20, 5 each of 30, 40 and 50
  EXPECT_EQ(status.protocols.at(0).answered, 21);
  EXPECT_TRUE(status.sessions.at(0).ended);
}

TEST(Session, ResumedAnswersEqualAnUninterruptedRun) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  {
    Store store(folder / "whole.db", Open::Create);
    store.add_run(test::run_plan(protocol, {"P01", "P02"}));
    play(store, protocol, no_limit);
  }
  int stops = 0;
  Store(folder / "cut.db", Open::Create).add_run(test::run_plan(protocol, {"P01", "P02"}));
  for (bool done = false; !done;) {
    Store store(folder / "cut.db", Open::Write);
    try {
      // The number of frames before the stop grows, so that stops fall into pauses, first frames and later
      // frames of different trials.
      play(store, protocol, 1009 + 37 * stops);
      done = true;
    } catch (const Stopped&) {
      ++stops;
    }
  }
  EXPECT_GT(stops, 5);
  EXPECT_EQ(answers(folder / "cut.db"), answers(folder / "whole.db"));
  sqlite::Connection look(folder / "cut.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM response"), 44);  // consent is an answer too
  EXPECT_EQ(look.integer("SELECT count(*) FROM presentation WHERE state = 'played'"), 42);
  // Frames of cut showings stay in the database, and a trial is shown again only while it has no answer.
  const auto cut = look.integer("SELECT count(*) FROM presentation WHERE state = 'interrupted'");
  EXPECT_GT(cut, 5);
  EXPECT_LE(cut, stops);  // a stop in a pause interrupts no showing
  EXPECT_EQ(look.integer("SELECT count(*) FROM presentation p WHERE state = 'interrupted' AND NOT EXISTS "
                         "(SELECT 1 FROM frame f WHERE f.presentation_id = p.presentation_id)"),
            0);
  EXPECT_EQ(look.integer("SELECT count(*) FROM response r JOIN unit u USING (unit_id) JOIN presentation p "
                         "USING (trial_id) WHERE p.attempt > r.attempt"),
            0);
}

TEST(Session, RestsAndBreaksBringTheirWords) {
  OneSession one(paced_pairs("", R"(
[[block]]
kind = "rest"
id = "silent"
seconds = 3

[[block]]
kind = "break"
id = "half_way"
title = "Half way"
text = "Look away."
seconds = 4
)"));
  one.run();
  ASSERT_GE(one.person.seen.size(), 2u);
  EXPECT_EQ(*(one.person.seen.end() - 2), "rest 3");
  EXPECT_EQ(one.person.seen.back(), "break 4 'Half way' Look away.");
}

TEST(Session, GoesThroughPagesPracticeAndPairsInOrder) {
  OneSession one(paced_pairs());
  one.run();
  // Each stimulus is preceded by the word "first" or "second" and half a second of black; the protocol's
  // black between the stimuli keeps its full length.
  std::vector<std::string> trial{"first 1",   "black 0.5",      "black 1", "second 1",
                                 "black 0.5", "ask preference", "rest 9",  "ask ease"};
  std::vector<std::string> expected{"ask age games"};
  for (int i = 0; i < 4; ++i) expected.insert(expected.end(), trial.begin(), trial.end());
  expected.emplace_back("ask remarks");
  EXPECT_EQ(one.person.seen, expected);
  EXPECT_EQ(one.row().state, "done");
  EXPECT_EQ(one.desk.stimuli.asked.size(), 8u);
  // Each judgement refers to both stimuli as they were shown.
  const Occasion& judged = one.person.occasions.at(1);
  ASSERT_EQ(judged.shown.size(), 2u);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(judged.shown[i].what.stimulus.method, one.desk.stimuli.asked[i]);
    EXPECT_NEAR(judged.shown[i].realised.mean, 20, 1e-6);
    EXPECT_NEAR(judged.shown[i].longest_ms, 50, 1e-6);
    EXPECT_NEAR(judged.shown[i].play_speed, 20 * 0.02, 1e-6);
  }
  EXPECT_EQ(one.count("presentation WHERE interval = 1 AND state = 'played'"), 4);
}

TEST(Session, PersonalAnswersStandInTheirFileAlone) {
  OneSession one(paced_pairs());
  one.run();
  const auto entries = one.personal.read("P01");
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].question, "age");
  EXPECT_EQ(entries[0].answer, "40");
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'age'"), 0);
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'games'"), 1);
  one.store.add_run([&] {
    RunPlan again = test::run_plan(one.protocol, {"P01"});
    again.sessions[0].visit = 2;
    return again;
  }());
  one.person.seen.clear();
  one.run();
  EXPECT_EQ(one.person.seen.at(0), "ask games") << "a person whose age is known is not asked again";
}

TEST(Session, WithoutAPersonalFileNothingPersonalIsAsked) {
  OneSession one(paced_pairs());
  const auto runs = one.open();
  EXPECT_THROW(
      run_session(one.protocol, runs.at(0).sessions.at(0), one.desk.parts(one.person, one.store), {}),
      base::Error);
  EXPECT_TRUE(one.person.seen.empty());
}

TEST(Session, NativeFramesAreTakenAsTheyComeAndHaveNoVerdict) {
  OneSession one(test::pairs());
  /// Every picture takes 10 or 20 ms, in turn.
  class Slow final : public Display {
   public:
    explicit Slow(VirtualClock& clock) : clock_(clock) {}
    std::string description() const override { return "slow"; }
    TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
    double refresh_hz() const override { return 0; }
    void render(Stimulus&) override {
      clock_.wait_until(clock_.now_ns() + (odd_ ? 20'000'000 : 10'000'000));
      odd_ = !odd_;
    }
    PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override {
      clock.wait_until(scheduled_ns);
      PresentTimes times;
      times.submitted_ns = clock.now_ns();
      return times;
    }

   private:
    VirtualClock& clock_;
    bool odd_ = false;
  };
  Slow display(one.desk.clock);
  SessionParts parts{one.desk.clock, display, one.desk.stimuli, one.person, one.store, &one.personal, true};
  const auto runs = one.open();
  run_session(one.protocol, runs.at(0).sessions.at(0), parts, {});
  EXPECT_EQ(one.count("presentation WHERE state = 'played' AND verdict IS NULL"), 8);
  const stats::FpsMoments& seen = one.person.occasions.at(1).shown.at(0).realised;
  EXPECT_NEAR(seen.mean, 1 / 0.015, 0.5);
  EXPECT_NEAR(seen.sd, 25, 0.1);
  EXPECT_NEAR(static_cast<double>(seen.frames), 67, 1);
}

TEST(Session, NativeTimingOnAClockThatStandsStillIsAnError) {
  OneSession one(test::pairs());
  EXPECT_THROW(one.run(), base::Error);
}

/// A frame's row has the facts that the fluid reports, and null for all other facts. Task 2 has the timing
/// "table2".
TEST(Session, FramesHoldWhatTheFluidSaysAndNothingElse) {
  class Accounting final : public Stimulus {
   public:
    std::string description() const override { return "accounting"; }
    std::int64_t length() const override { return 0; }
    void start(std::int64_t) override {}
    FrameFacts prepare(std::int64_t step) override {
      FrameFacts facts;
      if (step > 0) facts.tolerance = FrameTolerance{-0.5 * static_cast<double>(step), 0.5, 0.25, 20, 2};
      return facts;
    }
    void draw(const Canvas&) override {}
  };
  class OneStimulus final : public StimulusSource {
   public:
    Stimulus& stimulus(const Cell&) override { return stimulus_; }

   private:
    Accounting stimulus_;
  };
  const Protocol protocol = read_protocol(base::resource("protocols/task2.toml"));
  OneSession one(protocol);
  OneStimulus stimuli;
  SessionParts parts{one.desk.clock, one.desk.display, stimuli, one.person, one.store, nullptr, true};
  const auto runs = one.open();
  run_session(protocol, runs.at(0).sessions.at(0), parts, {});
  EXPECT_GT(one.count("frame WHERE content_step > 0"), 10 * 2 * 30 * 15);
  EXPECT_EQ(one.count("frame WHERE content_step > 0 AND (tau_fps, beta, active_fraction, mu_fps, delta_fps) "
                      "IS NOT (-0.5 * content_step, 0.5, 0.25, 20, 2)"),
            0);
  EXPECT_EQ(
      one.count("frame WHERE content_step = 0 AND coalesce(tau_fps, beta, active_fraction) IS NOT NULL"), 0);
  EXPECT_EQ(one.count("frame WHERE coalesce(particles, speed_limited, gaze_lost) IS NOT NULL"), 0);
}

TEST(FrameJournal, EveryFrameIsInTheStoreOrHandedBackOnce) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  for (const bool in_background : {false, true}) {
    const OpenUnit& unit = session.units.at(in_background ? 3 : 2);
    const auto id = store.begin_presentation(session.id, unit.trial_id, 1, 0, unit.trial->first, 0);
    FrameJournal journal(store, {1, id, 0}, GazeOrigin::Mouse, in_background);
    for (const FrameRecord& frame : test::frames(0, 1000)) journal.add(frame, {});
    const auto rest = journal.finish({});
    store.add_frames(id, 0, rest);
    sqlite::Connection look(folder / "study.db", Open::Read);
    EXPECT_EQ(look.integer("SELECT count(*) FROM frame WHERE presentation_id = " + std::to_string(id)), 1000);
  }
}

/// A display with a fixed refresh.
class FixedRefresh final : public Display {
 public:
  explicit FixedRefresh(double hz) : hz_(hz) {}
  std::string description() const override { return "fixed"; }
  TimingGrade grade() const override { return TimingGrade::Compositor; }
  double refresh_hz() const override { return hz_; }
  void render(Stimulus&) override {}
  PresentTimes present(std::int64_t, Clock&) override { return {}; }

 private:
  double hz_;
};

TEST(TrialIntervals, OnAFixedRefreshAreWholePeriodsWithoutDrift) {
  const Protocol protocol = test::pilot();
  const auto intervals = trial_intervals(protocol, {30, 0, 10}, FixedRefresh(90), 1);
  ASSERT_EQ(intervals.size(), 300u);
  std::int64_t sum = 0;
  for (const std::int64_t interval : intervals) {
    EXPECT_NEAR(static_cast<double>(interval), 1e9 / 30, 1);
    sum += interval;
  }
  EXPECT_EQ(sum, 10'000'000'000);
}

TEST(TrialIntervals, WhatADisplayCannotShowIsRefusedUnlessAccepted) {
  const Protocol protocol = test::pilot();
  // At 90 Hz a mean of 50 frames/s forces an SD of 18 frames/s.
  EXPECT_THROW(trial_intervals(protocol, {50, 0, 10}, FixedRefresh(90), 1), base::Error);
  EXPECT_THROW(check_settings(protocol, FixedRefresh(90)), base::Error);
  check_settings(protocol, NullDisplay());
}

}  // namespace
}  // namespace study
