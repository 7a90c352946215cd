/// Measurements of live cells before a session, and the judgement based on them.
#include "libstudy/check/measuring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "libstudy/check/kept_times.hpp"
#include "libstudy/check/measured_check.hpp"
#include "libstudy/display/null.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace apps {
namespace {

using study::FpsSetting;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

study::Protocol pilot_with(const std::string& key, const std::string& value) {
  return study::parse_protocol(test::with_keys(test::shipped_text("ptpe_pilot"), {{key, value}}),
                               "pilot.toml");
}

/// A stimulus and a display in one. Preparing a frame takes compute_s(step), and drawing it draw_s, on a
/// virtual clock.
class SlowStage final : public study::Stimulus, public study::Display {
 public:
  using Cost = std::function<double(std::int64_t)>;
  SlowStage(Cost compute_s, double draw_s) : compute_s_(std::move(compute_s)), draw_s_(draw_s) {}

  std::string description() const override { return "slow"; }
  std::int64_t length() const override { return 0; }
  void start(std::int64_t step) override { starts.push_back(step); }
  study::FrameFacts prepare(std::int64_t step) override {
    take(compute_s_(step));
    steps.push_back(step);
    return {};
  }
  void draw(const study::Canvas&) override {}
  study::TimingGrade grade() const override { return study::TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  void render(study::Stimulus&) override {
    take(draw_s_);
    ++rendered;
  }
  study::PresentTimes present(std::int64_t, study::Clock&) override { return {}; }

  study::VirtualClock clock;
  std::vector<std::int64_t> starts, steps;
  int rendered = 0;

 private:
  void take(double s) { clock.wait_until(clock.now_ns() + std::llround(1e9 * s)); }
  Cost compute_s_;
  double draw_s_;
};

std::vector<int> all_cells(const study::Protocol& protocol) {
  std::vector<int> out;
  for (std::size_t i = 0; i < protocol.design.cells.size(); ++i) out.push_back(static_cast<int>(i));
  return out;
}

study::StepTimes measured(const study::Protocol& protocol, SlowStage& stage) {
  return study::measure(protocol, all_cells(protocol), stage, stage, stage.clock, 0, {});
}

study::MeasuredReport judged(const study::Protocol& protocol, const study::StepTimes& times) {
  return study::judge_measured(protocol, {{all_cells(protocol), false, times}}, 0,
                               [&](const FpsSetting& setting) {
                                 return study::compile_schedule(setting, protocol.pacing, 0).intervals_ns;
                               });
}

TEST(Measure, GoesThroughTheLongestTrialAsASessionDoes) {
  const auto protocol = pilot_with("start_frame", "7");
  SlowStage stage([](std::int64_t step) { return 1e-5 * static_cast<double>(step); }, 0.004);
  const study::StepTimes times = measured(protocol, stage);
  // The longest trial has 500 frames: a mean of 50 frames/s for 10 s. The measurement includes the first
  // frame, which a session makes before the trial.
  ASSERT_EQ(times.compute_s.size(), 500u);
  EXPECT_EQ(times.draw_s.size(), 500u);
  EXPECT_THAT(stage.starts, ElementsAre(7));
  EXPECT_EQ(stage.steps.front(), 7);
  EXPECT_EQ(stage.steps.back(), 7 + 499);
  EXPECT_EQ(stage.rendered, 500);
  EXPECT_NEAR(times.compute_s.at(100), 1e-5 * 107, 1e-9);
  EXPECT_NEAR(times.draw_s.at(100), 0.004, 1e-9);
}

TEST(Measure, EndsAfterFiveSecondsWhereNoCellIsReached) {
  const auto protocol = study::test::pilot();
  SlowStage stage([](std::int64_t) { return 0.9; }, 0.1);
  const study::StepTimes times = measured(protocol, stage);
  EXPECT_EQ(times.compute_s.size(), 1u + 5);
  EXPECT_TRUE(judged(protocol, times).too_slow);
}

TEST(Measure, GoesOnForTheCellsThatAreStillReached) {
  const auto protocol = study::test::pilot();
  SlowStage stage([](std::int64_t) { return 0.05; }, 0.01);  // 60 ms a frame, so 100 frames take 6 s
  const study::StepTimes times = measured(protocol, stage);
  EXPECT_EQ(times.compute_s.size(), 100u);
  for (const study::MeasuredCell& cell : judged(protocol, times).cells)
    EXPECT_EQ(cell.too_slow, cell.setting.mean > 10)
        << study::setting_name(cell.setting) << ": " << cell.words;
}

TEST(Measure, SeesTheLaterFramesThatAreDearer) {
  auto protocol = pilot_with("mean_fps", "[20]");
  const auto dearer = [](std::int64_t step) { return step < 100 ? 0.02 : 0.09; };
  SlowStage stage(dearer, 0.001);
  const study::StepTimes times = measured(protocol, stage);
  EXPECT_GT(times.compute_s.size(), 100u);
  EXPECT_TRUE(judged(protocol, times).too_slow);
  study::StepTimes first = times;
  first.compute_s.resize(60);
  first.draw_s.resize(60);
  const auto hasty = judged(protocol, first);
  EXPECT_EQ(hasty.cells.front().setting.sd, 0);
  EXPECT_FALSE(hasty.cells.front().too_slow) << "the first frames alone look fast enough";
}

TEST(Measure, ANativeTrialLastsAsLongAsItWould) {
  const auto protocol = study::test::pairs();  // native timing, showings of 1 s
  SlowStage fast([](std::int64_t) { return 0.001; }, 0.001);
  EXPECT_EQ(measured(protocol, fast).compute_s.size(), 60u);
  SlowStage slow([](std::int64_t) { return 0.3; }, 0.1);
  EXPECT_EQ(measured(protocol, slow).compute_s.size(), 1u + 13) << "until 5 s are over";
}

TEST(Measure, CallsBackAfterEveryStepSoThatItCanBeStopped) {
  const auto protocol = study::test::pilot();
  SlowStage stage([](std::int64_t) { return 0.001; }, 0.001);
  int calls = 0;
  const auto stop = [&calls] {
    if (++calls == 3) throw std::runtime_error("enough");
  };
  EXPECT_THROW(study::measure(protocol, all_cells(protocol), stage, stage, stage.clock, 0, stop),
               std::runtime_error);
  EXPECT_EQ(stage.rendered, 1 + 3);
}

study::StepTimes steps_of(double compute_s, double draw_s, std::size_t steps = 500) {
  return {std::vector<double>(steps, compute_s), std::vector<double>(steps, draw_s)};
}

TEST(Rehearsal, AFastMachinePlaysTheScheduleAndAShowingLastsAsPlanned) {
  const auto protocol = study::test::pilot();
  const auto report = judged(protocol, steps_of(0.001, 0.001));
  EXPECT_FALSE(report.too_slow);
  ASSERT_EQ(report.cells.size(), protocol.design.cells.size());
  for (const study::MeasuredCell& cell : report.cells) {
    EXPECT_EQ(cell.words, "");
    EXPECT_NEAR(cell.showing_s, 10, 0.02);
    EXPECT_NEAR(cell.fps.mean, 500, 1e-6);
  }
}

TEST(Rehearsal, ASlowMachineIsCutAsASessionWouldBe) {
  const auto protocol = study::test::pilot();
  const auto report = judged(protocol, steps_of(0.65, 0.1));
  for (const study::MeasuredCell& cell : report.cells) {
    EXPECT_TRUE(cell.too_slow);
    EXPECT_THAT(cell.words, StartsWith("too slow live: 1.33 frames/s where "));
    EXPECT_NEAR(cell.showing_s, 20.25, 0.02) << "10 s, as much again, and what the next frame took";
  }
  const auto times = study::showing_times(protocol, report);
  EXPECT_EQ(times.size(), protocol.design.cells.size());
  EXPECT_NEAR(times.front(), 20.25, 0.02);
  EXPECT_EQ(study::showing_times(protocol, {}).front(), 10) << "nothing was measured";
}

TEST(Rehearsal, ASpreadThatTheMachineCannotFollowFailsThoughTheMeanIsReached) {
  auto protocol = pilot_with("mean_fps", "[50]");
  const auto report = judged(protocol, steps_of(0.015, 0.004));  // 52.6 frames/s
  const study::MeasuredCell& steady = report.cells.front();
  const study::MeasuredCell& spread = report.cells.back();
  ASSERT_EQ(steady.setting.sd, 0);
  ASSERT_EQ(spread.setting.sd, 20);
  EXPECT_FALSE(steady.too_slow);
  EXPECT_TRUE(spread.too_slow);
  EXPECT_THAT(spread.words, StartsWith("a trial would fail: "));
}

TEST(Rehearsal, ContentInRealTimeComputesSeveralStepsForAFrame) {
  auto protocol = pilot_with("mode", "\"real_time\"");
  const FpsSetting slow{10, 0, 10}, fast{50, 0, 10};
  EXPECT_EQ(study::content_steps(protocol, slow, 0), study::content_steps(protocol, fast, 0));
  // A step of 1/60 s takes 20 ms: the six steps of a frame do not fit into 100 ms, while one or two fit into
  // the fast setting's interval.
  const study::Rehearsal six = study::rehearse(protocol, slow, steps_of(0.020, 0.001, 600), {}, 0);
  EXPECT_NEAR(six.frame_s.at(10), 6 * 0.020 + 0.001, 1e-9);
  EXPECT_EQ(six.frame_s.size(), 99u);
  const study::Rehearsal cheap = study::rehearse(protocol, slow, steps_of(0.010, 0.001, 600), {}, 0);
  EXPECT_NEAR(cheap.showing_s, 10, 0.02);
}

TEST(Rehearsal, StepsThatWereNotMeasuredTakeWhatTheLastOnesDid) {
  study::StepTimes times = steps_of(0.001, 0.001, 100);
  std::fill(times.compute_s.end() - 30, times.compute_s.end(), 0.2);
  const auto protocol = study::test::pilot();
  const study::Rehearsal rehearsal = study::rehearse(protocol, {20, 0, 10}, times, {}, 0);
  EXPECT_NEAR(rehearsal.frame_s.back(), 0.2 + 0.001, 1e-9);
  EXPECT_GT(rehearsal.showing_s, 15);
  EXPECT_EQ(rehearsal.measured, times.compute_s.size() - 1);
}

// The trial needs 200 steps. A hundred were measured, the last six of them slow; each other step is taken to
// cost the mean of the last 30.
TEST(Rehearsal, TheNinetyFifthPercentileIsOfMeasuredFramesAlone) {
  study::StepTimes times = steps_of(0.001, 0, 100);
  std::fill(times.compute_s.end() - 6, times.compute_s.end(), 0.04);
  auto protocol = study::test::pilot();
  protocol.design.cells = {{.stimulus = {}, .setting = {20, 0, 10}}};
  const auto report = study::judge_measured(protocol, {{{0}, false, times}}, 0, [](const FpsSetting&) {
    return std::vector<std::int64_t>(200, 50'000'000);
  });
  ASSERT_EQ(report.cells.size(), 1u);
  EXPECT_NEAR(report.cells[0].p95_ms, 40, 1e-6);
  EXPECT_NEAR(report.cells[0].mean_ms, (93 * 1 + 6 * 40) / 99.0, 0.1);
}

TEST(KeptTimes, AreReadBackUnderTheirKeyAlone) {
  const study::test::TemporaryFolder folder;
  const study::StepTimes times{{0, 0.1, 1.0 / 3}, {0, 2e-5, 0.25}};
  study::keep_step_times(folder.path() / "made", "this station", times);
  const auto read = study::read_step_times(folder.path() / "made", "this station");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->compute_s, times.compute_s);
  EXPECT_EQ(read->draw_s, times.draw_s);
  EXPECT_FALSE(study::read_step_times(folder.path() / "made", "another station"));
  EXPECT_FALSE(study::read_step_times({}, "this station"));
  study::keep_step_times({}, "this station", times);  // keeps nothing, without an error
}

TEST(KeptTimes, DamagedFilesAreMeasuredAgain) {
  const study::test::TemporaryFolder folder;
  for (const char* text :
       {"{", "[]", R"({"key":"k"})", R"({"key":"k","compute_s":[0],"draw_s":[]})",
        R"({"key":"k","compute_s":[-1],"draw_s":[0]})", R"({"key":"other","compute_s":[0],"draw_s":[0]})"}) {
    study::keep_step_times(folder.path(), "k", {{0}, {0}});
    ASSERT_TRUE(study::read_step_times(folder.path(), "k"));
    for (const auto& file : std::filesystem::directory_iterator(folder.path()))
      std::ofstream(file.path()) << text;
    EXPECT_FALSE(study::read_step_times(folder.path(), "k")) << text;
  }
}

}  // namespace
}  // namespace apps
