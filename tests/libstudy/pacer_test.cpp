#include "libstudy/pacing/pacer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "libstudy/pacing/real_time.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using study::TimingGrade;
using study::Verdict;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t half_ms = 500'000;
constexpr study::ShowingBounds bounds{half_ms, 10'000 * ms};

/// A stimulus whose steps take time on a virtual clock.
class TimedStimulus final : public study::Stimulus {
 public:
  explicit TimedStimulus(study::VirtualClock& clock, std::int64_t length = 0)
      : clock_(clock), length_(length) {}
  std::string description() const override { return "timed stimulus"; }
  std::int64_t length() const override { return length_; }
  void start(std::int64_t step) override { starts.push_back(step); }
  study::FrameFacts prepare(std::int64_t step) override {
    const auto count = static_cast<std::int64_t>(steps.size());
    clock_.wait_until(clock_.now_ns() + (cost_ns.count(count) ? cost_ns[count] : 0));
    steps.push_back(step);
    return {static_cast<double>(step) / 60, {step, 2 * step}, study::FrameTolerance{-3, 1, 1, {}, {}}, {}};
  }
  void draw(const study::Canvas&) override {}

  std::map<std::int64_t, std::int64_t> cost_ns;  // by frame index
  std::vector<std::int64_t> starts, steps;

 private:
  study::VirtualClock& clock_;
  std::int64_t length_;
};

class PlainDisplay final : public study::Display {
 public:
  std::string description() const override { return "plain display"; }
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  void render(study::Stimulus&) override { ++rendered; }
  study::PresentTimes present(std::int64_t scheduled_ns, study::Clock& clock) override {
    clock.wait_until(scheduled_ns);
    study::PresentTimes times;
    times.submitted_ns = clock.now_ns();
    return times;
  }
  int rendered = 0;
};

/// One trial of a TimedStimulus on a virtual clock.
struct Stage {
  study::VirtualClock clock;
  TimedStimulus stimulus{clock};
  PlainDisplay display;
  study::ContentRules content;

  study::PlayedTrial play(const std::vector<std::int64_t>& intervals_ns) {
    return study::play_trial(intervals_ns, content, stimulus, display, clock, bounds, {});
  }
};

std::vector<std::int64_t> onsets(const study::PlayedTrial& played) {
  std::vector<std::int64_t> out;
  for (const auto& frame : played.frames)
    out.push_back(frame.times.submitted_ns - played.frames[0].scheduled_ns);
  return out;
}

TEST(PlayTrial, VirtualTimeFollowsTheScheduleExactly) {
  const auto setting = study::FpsSetting{50, 20, 10};
  const auto schedule = study::compile_schedule(setting, {}, 4);
  Stage stage;
  const auto played = stage.play(schedule.intervals_ns);
  ASSERT_EQ(played.frames.size(), schedule.intervals_ns.size());
  std::int64_t onset = 0;
  for (std::size_t i = 0; i < played.frames.size(); ++i) {
    const auto& frame = played.frames[i];
    EXPECT_EQ(frame.index, static_cast<std::int64_t>(i));
    EXPECT_EQ(frame.content_step, frame.index);
    EXPECT_EQ(frame.times.submitted_ns, frame.scheduled_ns);
    EXPECT_EQ(frame.scheduled_ns - played.frames[0].scheduled_ns, onset);
    EXPECT_FALSE(frame.late);
    EXPECT_EQ(frame.facts.particles_by_level.at(1), 2 * frame.index);
    EXPECT_EQ(frame.facts.tolerance.value().tau_fps.value(), -3);
    onset += schedule.intervals_ns[i];
  }
  EXPECT_EQ(played.end_ns - played.frames[0].scheduled_ns, onset);
  const auto verdict = study::judge_trial(setting, {}, played, {}, TimingGrade::CpuSubmit);
  EXPECT_EQ(verdict.verdict, Verdict::Pass) << verdict.reason;
  EXPECT_NEAR(verdict.realised.mean, 50, 1e-5);
  EXPECT_NEAR(verdict.realised.sd, 20, 1e-5);
}

TEST(PlayTrial, LateFrameIsShownAtOnceAndDeadlinesStay) {
  Stage stage;
  stage.stimulus.cost_ns[2] = 35 * ms;  // frame 2 is due at 40 ms, ready at 20 + 35 ms
  const auto played = stage.play(std::vector<std::int64_t>(5, 20 * ms));
  EXPECT_EQ(onsets(played), (std::vector<std::int64_t>{0, 20 * ms, 55 * ms, 60 * ms, 80 * ms}));
  EXPECT_THAT(stage.stimulus.steps, testing::ElementsAre(0, 1, 2, 3, 4));
  for (const auto& frame : played.frames) EXPECT_EQ(frame.late, frame.index == 2);
  EXPECT_EQ(played.end_ns - played.frames[0].scheduled_ns, 100 * ms);
}

TEST(PlayTrial, LongStallCatchesUpWithoutSkipping) {
  Stage stage;
  stage.stimulus.cost_ns[1] = 70 * ms;
  for (std::int64_t i = 2; i < 8; ++i) stage.stimulus.cost_ns[i] = 5 * ms;
  const auto played = stage.play(std::vector<std::int64_t>(8, 20 * ms));
  EXPECT_EQ(onsets(played),
            (std::vector<std::int64_t>{0, 70 * ms, 75 * ms, 80 * ms, 85 * ms, 100 * ms, 120 * ms, 140 * ms}));
  EXPECT_THAT(stage.stimulus.steps, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST(PlayTrial, LastFrameThatComesTooLateStaysForItsInterval) {
  Stage stage;
  stage.stimulus.cost_ns[2] = 90 * ms;
  const auto played = stage.play(std::vector<std::int64_t>(3, 20 * ms));
  EXPECT_EQ(played.end_ns - played.frames.back().times.submitted_ns, 20 * ms);
}

TEST(PlayTrial, LatenessBoundIsExclusive) {
  for (const std::int64_t late : {half_ms, half_ms + 1}) {
    Stage stage;
    stage.stimulus.cost_ns[1] = 20 * ms + late;
    const auto played = stage.play(std::vector<std::int64_t>(3, 20 * ms));
    EXPECT_EQ(played.frames[1].late, late > half_ms);
  }
}

TEST(PlayTrial, ContentLoopsOrHolds) {
  for (const auto at_end : {study::AtEnd::Loop, study::AtEnd::Hold}) {
    study::VirtualClock clock;
    TimedStimulus stimulus(clock, 4);
    PlainDisplay display;
    study::ContentRules content;
    content.start_frame = 1;
    content.at_end = at_end;
    study::play_trial(std::vector<std::int64_t>(7, ms), content, stimulus, display, clock, bounds, {});
    if (at_end == study::AtEnd::Loop) {
      EXPECT_THAT(stimulus.steps, testing::ElementsAre(1, 2, 3, 1, 2, 3, 1));
      EXPECT_THAT(stimulus.starts, testing::ElementsAre(1, 1, 1));
    } else {
      EXPECT_THAT(stimulus.steps, testing::ElementsAre(1, 2, 3, 3, 3, 3, 3));
      EXPECT_THAT(stimulus.starts, testing::ElementsAre(1));
    }
  }
}

TEST(PlayTrial, RealTimeContentFollowsTheSchedule) {
  Stage stage;
  stage.content.real_time = true;
  stage.content.content_step_s = 0.01;
  stage.stimulus.cost_ns[2] = 500 * ms;  // late frames do not change the content steps shown
  stage.play({25 * ms, 25 * ms, 100 * ms, 5 * ms, 5 * ms});
  EXPECT_THAT(stage.stimulus.steps, testing::ElementsAre(0, 2, 5, 15, 15));
}

TEST(PlayTrial, TellsTheJournalOfEveryFrameInOrder) {
  Stage stage;
  std::vector<std::int64_t> told;
  const auto played =
      study::play_trial({ms, ms, ms}, stage.content, stage.stimulus, stage.display, stage.clock, bounds,
                        [&](const auto& frame) { told.push_back(frame.index); });
  EXPECT_THAT(told, testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(stage.display.rendered, 3);
}

TEST(PlayTrial, RefusesBadSchedulesAndShortContent) {
  Stage stage;
  EXPECT_THROW(stage.play({}), base::Error);
  EXPECT_THROW(stage.play({ms, 0}), base::Error);
  TimedStimulus brief(stage.clock, 10);
  stage.content.start_frame = 10;
  EXPECT_THROW(study::play_trial({ms}, stage.content, brief, stage.display, stage.clock, bounds, {}),
               base::Error);
  EXPECT_TRUE(brief.steps.empty());
}

/// Plays five frames of 20 ms. Each but the first takes `cost_ns`. The trial is cut 50 ms past its planned
/// end.
study::PlayedTrial played_at(std::int64_t cost_ns) {
  Stage stage;
  for (std::int64_t i = 1; i < 5; ++i) stage.stimulus.cost_ns[i] = cost_ns;
  return study::play_trial(std::vector<std::int64_t>(5, 20 * ms), stage.content, stage.stimulus,
                           stage.display, stage.clock, {half_ms, 50 * ms}, {});
}

TEST(PlayTrial, IsCutWhenItGoesOnForTooLong) {
  const auto played = played_at(60 * ms);  // the fourth frame is ready at 180 ms, 80 past the planned end
  EXPECT_EQ(onsets(played), (std::vector<std::int64_t>{0, 60 * ms, 120 * ms}));
  EXPECT_EQ(played.cut, 2);
  EXPECT_EQ(played.end_ns - played.frames.front().scheduled_ns, 180 * ms);
  const auto verdict = study::judge_trial({50, 0, 0.1}, {}, played, {}, TimingGrade::CpuSubmit);
  EXPECT_EQ(verdict.verdict, Verdict::Fail);
  EXPECT_TRUE(verdict.cut);
  EXPECT_THAT(verdict.reason, testing::StartsWith("cut 0.18 s after its start: 3 of 5 frames shown; "));
}

TEST(PlayTrial, IsNotCutWhileALateFrameStillComesInTime) {
  const auto played = played_at(37 * ms);  // the last frame is ready at 148 ms of 150
  EXPECT_EQ(played.frames.size(), 5u);
  EXPECT_FALSE(played.cut);
  EXPECT_FALSE(study::judge_trial({50, 0, 0.1}, {}, played, {}, TimingGrade::CpuSubmit).cut);
}

TEST(PlayTrial, MayGoOnForItsOwnLengthAndAtLeastFiveSeconds) {
  EXPECT_EQ(study::showing_bounds({}, 30).overrun_ns, 30'000 * ms);
  EXPECT_EQ(study::showing_bounds({}, 2).overrun_ns, 5'000 * ms);
  study::TimingTolerance tolerance;
  tolerance.overrun_s = 0.25;
  EXPECT_EQ(study::showing_bounds(tolerance, 30).overrun_ns, 250 * ms);
  EXPECT_EQ(study::showing_bounds(tolerance, 30).late_after_ns, half_ms);
}

TEST(PlayNative, IsCutWhenItsLastFrameTakesTooLong) {
  for (const std::int64_t last_ms : {60, 61}) {
    Stage stage;
    for (std::int64_t i = 1; i < 3; ++i) stage.stimulus.cost_ns[i] = 40 * ms;
    stage.stimulus.cost_ns[3] = last_ms * ms;  // begins at 80 ms of a trial of 90 ms
    const auto played =
        study::play_native(0.09, stage.content, stage.stimulus, stage.display, stage.clock, 50 * ms, {});
    EXPECT_EQ(played.frames.size(), 3u);
    const auto verdict = study::describe_trial(played, TimingGrade::CpuSubmit);
    EXPECT_EQ(verdict.cut, last_ms == 61);
    EXPECT_EQ(verdict.verdict, last_ms == 61 ? Verdict::Fail : Verdict::Pass);
    EXPECT_EQ(verdict.reason, last_ms == 61 ? "cut 0.141 s after its start" : "");
  }
}

study::PlayedTrial played_with(const std::vector<std::int64_t>& intervals_ns,
                               const std::map<std::int64_t, std::int64_t>& cost_ns) {
  Stage stage;
  stage.stimulus.cost_ns = cost_ns;
  return stage.play(intervals_ns);
}

TEST(JudgeTrial, OneLateFrameDegradesEvenWithGoodMoments) {
  const study::FpsSetting setting{50, 10, 10};
  const auto schedule = study::compile_schedule(setting, {}, 4);
  const auto played = played_with(schedule.intervals_ns, {{100, schedule.intervals_ns[99] + 600'000}});
  const auto verdict = study::judge_trial(setting, {}, played, {}, TimingGrade::CpuSubmit);
  EXPECT_EQ(verdict.verdict, Verdict::Degraded);
  EXPECT_EQ(verdict.late, 1);
  EXPECT_NEAR(verdict.worst_late_ms, 0.6, 1e-9);
  EXPECT_NEAR(verdict.realised.mean, 50, 0.25);
  EXPECT_NEAR(verdict.realised.sd, 10, 0.25);
  EXPECT_THAT(verdict.reason, testing::HasSubstr("1 late frame, the worst by 0.6 ms"));
}

TEST(JudgeTrial, LatenessWithinTheBoundPasses) {
  const study::FpsSetting setting{50, 20, 10};
  const auto schedule = study::compile_schedule(setting, {}, 4);
  std::map<std::int64_t, std::int64_t> cost;
  for (std::int64_t i = 1; i < 500; i += 3)
    cost[i] = schedule.intervals_ns[static_cast<std::size_t>(i - 1)] + 100'000;
  const auto verdict =
      study::judge_trial(setting, {}, played_with(schedule.intervals_ns, cost), {}, TimingGrade::CpuSubmit);
  EXPECT_EQ(verdict.verdict, Verdict::Pass) << verdict.reason;
  EXPECT_EQ(verdict.late, 0);
  EXPECT_NEAR(verdict.worst_late_ms, 0.1, 1e-6);
}

TEST(JudgeTrial, WrongMomentsDegradeThenFail) {
  const auto judged = [](double realised_mean, double nominal_mean) {
    const auto schedule = study::compile_schedule({realised_mean, 5, 10}, {}, 4);
    return study::judge_trial({nominal_mean, 5, 10}, {}, played_with(schedule.intervals_ns, {}), {},
                              TimingGrade::CpuSubmit);
  };
  EXPECT_EQ(judged(30.1, 30).verdict, Verdict::Pass);
  EXPECT_EQ(judged(30.3, 30).verdict, Verdict::Degraded);
  EXPECT_THAT(judged(30.3, 30).reason, testing::HasSubstr("mean 30.3 frames/s is off by 1 %"));
  EXPECT_EQ(judged(32, 30).verdict, Verdict::Fail);
  const auto judged_sd = [](double realised, double nominal) {
    const auto schedule = study::compile_schedule({30, realised, 10}, {}, 4);
    return study::judge_trial({30, nominal, 10}, {}, played_with(schedule.intervals_ns, {}), {},
                              TimingGrade::CpuSubmit)
        .verdict;
  };
  EXPECT_EQ(judged_sd(0.2, 0), Verdict::Pass);
  EXPECT_EQ(judged_sd(0.3, 0), Verdict::Degraded);
  EXPECT_EQ(judged_sd(2.6, 0), Verdict::Fail);
  EXPECT_EQ(judged_sd(20.35, 20), Verdict::Pass);
  EXPECT_EQ(judged_sd(20.45, 20), Verdict::Degraded);
}

TEST(JudgeTrial, NamesTheMeanThatTheRulesName) {
  const study::FpsSetting setting{30, 15, 10};
  study::PacingRules arithmetic;
  arithmetic.mean = study::FpsMean::Arithmetic;
  const auto played = played_with(study::compile_schedule(setting, arithmetic, 4).intervals_ns, {});
  EXPECT_EQ(study::judge_trial(setting, arithmetic, played, {}, TimingGrade::CpuSubmit).verdict,
            Verdict::Pass);
  EXPECT_EQ(study::judge_trial(setting, {}, played, {}, TimingGrade::CpuSubmit).verdict, Verdict::Fail);
}

TEST(JudgeTrial, UsesDisplayTimesOnlyWhereTheGradeVouchesForThem) {
  auto played = played_with(std::vector<std::int64_t>(10, 20 * ms), {});
  std::int64_t shown = 0;
  for (auto& frame : played.frames) frame.times.actual_display_ns = shown += 25 * ms;
  played.end_ns = shown + 25 * ms;
  EXPECT_NEAR(study::realised_intervals(played, TimingGrade::DisplayFeedback)[0], 0.025, 1e-12);
  EXPECT_NEAR(study::realised_intervals(played, TimingGrade::CpuSubmit)[0], 0.020, 1e-12);
  played.frames[3].times.actual_display_ns = -1;
  EXPECT_NEAR(study::realised_intervals(played, TimingGrade::DisplayFeedback)[0], 0.020, 1e-12);
}

TEST(JudgeTrial, ACompositorsFramesAreOnAndLateByWhatItPredicted) {
  auto played = played_with(std::vector<std::int64_t>(10, 20 * ms), {});
  for (auto& frame : played.frames) frame.times.predicted_display_ns = frame.scheduled_ns;
  played.frames[3].times.predicted_display_ns += 5 * ms;
  for (auto& frame : played.frames) frame.times.submitted_ns -= 11 * ms;  // submitted one period earlier
  const auto on = study::realised_intervals(played, TimingGrade::Compositor);
  EXPECT_NEAR(on[2], 0.025, 1e-12);
  EXPECT_NEAR(on[3], 0.015, 1e-12);
  const auto verdict = study::judge_trial({50, 1, 0.2}, {}, played, {}, TimingGrade::Compositor);
  EXPECT_EQ(verdict.late, 1);
  EXPECT_NEAR(verdict.worst_late_ms, 5, 1e-9);
  EXPECT_EQ(study::judge_trial({50, 1, 0.2}, {}, played, {}, TimingGrade::CpuSubmit).late, 0);
}

TEST(JudgeTrial, DescribesTheIntervals) {
  const auto played = played_with({10 * ms, 20 * ms, 10 * ms, 40 * ms}, {});
  const auto verdict = study::judge_trial({50, 31.5, 0.08}, {}, played, {}, TimingGrade::CpuSubmit);
  EXPECT_NEAR(verdict.shortest_ms, 10, 1e-9);
  EXPECT_NEAR(verdict.longest_ms, 40, 1e-9);
  EXPECT_NEAR(verdict.p95_ms, 37, 1e-9);
  // Rates 100, 50, 100, 25: deviations 31.25, -18.75, 31.25, -43.75 from their mean.
  EXPECT_NEAR(verdict.lag1, (-2 * 31.25 * 18.75 - 31.25 * 43.75) / 4218.75, 1e-9);
}

TEST(JudgeTrial, OnsetsThatDoNotAscendFail) {
  auto played = played_with({10 * ms, 20 * ms, 10 * ms}, {});
  played.frames[2].times.submitted_ns = played.frames[1].times.submitted_ns;
  const auto verdict = study::judge_trial({50, 0, 0.04}, {}, played, {}, TimingGrade::CpuSubmit);
  EXPECT_EQ(verdict.verdict, Verdict::Fail);
  EXPECT_THAT(verdict.reason, testing::HasSubstr("do not ascend"));
}

TEST(RealTimeScheduling, SaysWhatWasGranted) {
  const study::RealTimeScheduling scheduling;
  EXPECT_THAT(scheduling.note(), testing::HasSubstr("SCHED_FIFO"));
  EXPECT_THAT(scheduling.note(), testing::HasSubstr("timer slack"));
}

}  // namespace
