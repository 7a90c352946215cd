#include "libstudy/session/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "libstudy/display/null.hpp"
#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/session/frame_journal.hpp"
#include "libstudy/store/ratings.hpp"
#include "libstudy/store/status.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

using sqlite::Open;

/// One process's share of a study: plays what is open until `frames` more frames were shown.
void play(Store& store, const Protocol& protocol, std::int64_t frames) {
  VirtualClock clock;
  NullDisplay display;
  NullStimulus stimulus(protocol.content.content_step_s);
  PtpeObserver observer(parse_ptpe_observer("ptpe:a=31,b=0.035"));
  SessionHooks hooks;
  hooks.stop = [&] { return frames-- <= 0; };
  for (const OpenRun& run : store.open_runs()) {
    for (const OpenSession& session : run.sessions) {
      run_session(protocol, session, {clock, display, stimulus, observer, store, true}, hooks);
    }
  }
}

constexpr std::int64_t no_limit = 1'000'000'000;

/// Participant, position, score and realised moments of every trial.
auto answers(const std::filesystem::path& path) {
  std::vector<std::tuple<std::string, int, int, double, double>> rows;
  for (const RatingRow& row : read_ratings(path)) {
    rows.emplace_back(row.participant, row.position, row.rating.value_or(0),
                      row.timing ? row.timing->realised.mean : 0, row.timing ? row.timing->realised.sd : 0);
  }
  return rows;
}

TEST(Session, PlaysThePlanAndTheRealisedMomentsAreTheNominalOnes) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  Store store(folder / "study.db", Open::Create);
  const auto run = store.add_run(test::run_plan(protocol, {"P01"}));
  play(store, protocol, no_limit);
  for (const RatingRow& row : read_ratings(folder / "study.db")) {
    ASSERT_TRUE(row.rating && row.timing);
    EXPECT_EQ(row.timing->verdict, Verdict::Pass) << row.timing->reason;
    EXPECT_NEAR(row.timing->realised.mean, row.nominal.mean, 1e-6 * row.nominal.mean);
    EXPECT_NEAR(row.timing->realised.sd, row.nominal.sd, 1e-6 * row.nominal.mean);
    EXPECT_EQ(static_cast<std::int64_t>(row.timing->realised.frames), frame_count(row.nominal));
  }
  const auto certificate = read_certificate(folder / "study.db", run, FpsMean::Harmonic);
  ASSERT_EQ(certificate.size(), 21u);
  for (const CertificateRow& row : certificate) EXPECT_EQ(row.pass, 1);
  const StudyStatus status = read_status(folder / "study.db");
  EXPECT_EQ(status.frames, 7000);  // 10 s at 10 (2x), 20 (4x), 30, 40 and 50 (5x) frames/s
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
      // A prime stride, so that stops fall into gaps, first and later frames of different trials.
      play(store, protocol, 1009 + 37 * stops);
      done = true;
    } catch (const Stopped&) {
      ++stops;
    }
  }
  EXPECT_GT(stops, 5);
  EXPECT_EQ(answers(folder / "cut.db"), answers(folder / "whole.db"));
  sqlite::Connection look(folder / "cut.db", Open::Read);
  EXPECT_EQ(look.integer("SELECT count(*) FROM response"), 42);
  EXPECT_EQ(look.integer("SELECT count(*) FROM presentation WHERE state = 'played'"), 42);
  // Frames of what was cut stay, and a trial is shown again only while it has no answer.
  const auto cut = look.integer("SELECT count(*) FROM presentation WHERE state = 'interrupted'");
  EXPECT_GT(cut, 5);
  EXPECT_LE(cut, stops);  // a stop in the gap cuts nothing
  EXPECT_EQ(look.integer("SELECT count(*) FROM presentation p WHERE state = 'interrupted' AND NOT EXISTS "
                         "(SELECT 1 FROM frame f WHERE f.presentation_id = p.presentation_id)"),
            0);
  EXPECT_EQ(look.integer("SELECT count(*) FROM presentation p JOIN response r USING (trial_id) "
                         "WHERE p.presentation_id > r.presentation_id"),
            0);
}

TEST(Session, EachFrameHoldsTauWhenAModelIsInForce) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(protocol, {"P01", "P02"}));
  const auto sessions = store.open_runs().at(0).sessions;
  VirtualClock clock;
  NullDisplay display;
  NullStimulus stimulus(protocol.content.content_step_s);
  PtpeObserver observer(parse_ptpe_observer("ptpe:a=31,b=0.035"));
  SessionParts parts{clock, display, stimulus, observer, store, true};
  run_session(protocol, sessions.at(0), parts, {});
  parts.ptpe = stats::PtpeModel{24, 0.02};
  run_session(protocol, sessions.at(1), parts, {});
  sqlite::Connection look(folder / "study.db", Open::Read);
  const std::string frames =
      "SELECT count(*) FROM frame JOIN presentation USING (presentation_id) JOIN trial t USING (trial_id) "
      "JOIN session s USING (session_id) WHERE ";
  EXPECT_EQ(look.integer(frames + "participant = 'P01' AND tolerance_fps <> 0"), 0);
  EXPECT_EQ(look.integer(frames + "participant = 'P02' AND (tolerance_fps = 0) <> (frame_index < 2)"), 0);
  // Without fluctuation tau is mu - a from the first interval on.
  EXPECT_EQ(look.integer(frames + "participant = 'P02' AND nominal_sd_fps = 0 AND frame_index >= 2 "
                                  "AND abs(tolerance_fps - (nominal_mean_fps - 24)) > 1e-5"),
            0);
}

/// Answers off the scale.
class Broken final : public Responder {
 public:
  std::optional<std::string> simulated() const override { return "broken"; }
  Answer answer(const Question&, const ShownTrial&, Clock&) override { return {8}; }
};

TEST(Session, AnAnswerOffTheScaleIsAnErrorAndIsNotStored) {
  const test::TemporaryFolder folder;
  const Protocol protocol = test::pilot();
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(protocol, {"P01"}));
  VirtualClock clock;
  NullDisplay display;
  NullStimulus stimulus(0.01);
  Broken broken;
  const auto runs = store.open_runs();
  EXPECT_THROW(
      run_session(protocol, runs[0].sessions[0], {clock, display, stimulus, broken, store, true}, {}),
      base::Error);
  EXPECT_EQ(read_status(folder / "study.db").protocols.at(0).answered, 0);
}

TEST(FrameJournal, EveryFrameIsInTheStoreOrHandedBackOnce) {
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", Open::Create);
  store.add_run(test::run_plan(test::pilot(), {"P01"}));
  const auto session = store.open_runs().at(0).sessions.at(0);
  for (const bool in_background : {false, true}) {
    const auto id = store.begin_presentation(session.id, session.trials[in_background].id, 1, 0);
    FrameJournal journal(store, id, 0, in_background);
    for (const FrameRecord& frame : test::frames(0, 1000)) journal.add(frame);
    const auto rest = journal.finish();
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
  PresentTimes present(const Clock&) override { return {}; }

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
  // On 90 Hz, 50 frames/s forces delta >= 16.
  EXPECT_THROW(trial_intervals(protocol, {50, 0, 10}, FixedRefresh(90), 1), base::Error);
  EXPECT_THROW(check_settings(protocol, FixedRefresh(90)), base::Error);
  check_settings(protocol, NullDisplay());
}

}  // namespace
}  // namespace study
