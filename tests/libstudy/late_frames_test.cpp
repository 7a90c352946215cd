#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "stats/base/file.hpp"
#include "tests/libstudy/session_fixture.hpp"
#include "tests/libstudy/trials_of.hpp"

namespace study {
namespace {

using sqlite::Open;
using ::testing::ElementsAre;

/// Presenting frame i takes delay_ns(i) on the virtual clock, so that chosen frames are late.
class LateDisplay final : public Display {
 public:
  LateDisplay(VirtualClock& clock, std::function<std::int64_t(std::int64_t)> delay_ns)
      : clock_(clock), delay_ns_(std::move(delay_ns)) {}
  std::string description() const override { return "late"; }
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  void render(Stimulus&) override {}
  PresentTimes present(std::int64_t scheduled_ns, Clock&) override {
    clock_.wait_until(scheduled_ns);
    clock_.wait_until(clock_.now_ns() + delay_ns_(frame_++));
    PresentTimes times;
    times.submitted_ns = clock_.now_ns();
    return times;
  }

 private:
  VirtualClock& clock_;
  std::function<std::int64_t(std::int64_t)> delay_ns_;
  std::int64_t frame_ = 0;
};

/// The pilot with one setting, a constant 50 frames/s: one trial of 500 frames of 20 ms.
Protocol one_constant_setting() {
  return parse_protocol(
      test::with_keys(test::shipped_text("ptpe_pilot"), {{"mean_fps", "[50]"}, {"sd_fps", "[0]"}}),
      "one.toml");
}

using Delay = std::function<std::int64_t(std::int64_t)>;
const Delay punctual = [](std::int64_t) { return 0; };
const Delay frame_100_is_2_ms_late = [](std::int64_t frame) { return frame == 100 ? 2'000'000 : 0; };
const Delay each_takes_25_ms = [](std::int64_t) { return 25'000'000; };
const Delay each_takes_250_ms = [](std::int64_t) { return 250'000'000; };

/// Runs one trial for each participant, each with a display of their own. Returns the only row of the
/// certificate.
CertificateRow certificate_of(const std::filesystem::path& path, const std::vector<Delay>& delays) {
  const Protocol protocol = one_constant_setting();
  Store store(path, Open::Create);
  std::vector<std::string> participants;
  for (std::size_t i = 0; i < delays.size(); ++i) participants.push_back("P" + std::to_string(i));
  const auto id = store.add_run(test::run_plan(protocol, participants));
  const OpenRun run = store.open_runs().at(0);
  for (std::size_t i = 0; i < delays.size(); ++i) {
    VirtualClock clock;
    LateDisplay display(clock, delays[i]);
    test::NullStimuli stimuli(protocol.content.content_step_s);
    const auto observer = test::ptpe_observer();
    run_session(protocol, run.sessions.at(i), {clock, display, stimuli, *observer, store, nullptr, true}, {});
  }
  const auto rows = read_certificate(path, id, FpsMean::Harmonic);
  EXPECT_EQ(rows.size(), 1u);
  return rows.at(0);
}

std::vector<std::int64_t> late_frames(const std::filesystem::path& path) {
  sqlite::Connection file(path, Open::Read);
  std::vector<std::int64_t> frames;
  for (sqlite::Statement row(file, "SELECT frame_index FROM frame WHERE late ORDER BY 1"); row.step();)
    frames.push_back(row.integer(0));
  return frames;
}

TEST(LateFrames, WithoutDelayTheTrialPasses) {
  const test::TemporaryFolder folder;
  const CertificateRow row = certificate_of(folder / "study.db", {punctual});
  EXPECT_THAT(std::make_tuple(row.pass, row.degraded, row.fail), testing::FieldsAre(1, 0, 0));
  EXPECT_EQ(row.frames, 500);
  EXPECT_EQ(row.late, 0);
  EXPECT_EQ(row.worst_late_ms, 0);
  EXPECT_NEAR(row.mean, 50, 1e-9);
  EXPECT_NEAR(row.sd, 0, 1e-6);
  EXPECT_TRUE(late_frames(folder / "study.db").empty());
}

TEST(LateFrames, OneFrameLateByTwoMillisecondsDegradesTheTrial) {
  const test::TemporaryFolder folder;
  const CertificateRow row = certificate_of(folder / "study.db", {frame_100_is_2_ms_late});
  EXPECT_THAT(std::make_tuple(row.pass, row.degraded, row.fail), testing::FieldsAre(0, 1, 0));
  EXPECT_THAT(late_frames(folder / "study.db"), ElementsAre(100));
  EXPECT_EQ(row.late, 1);
  EXPECT_NEAR(row.worst_late_ms, 2, 1e-9);
  // Frame 99 lasts 22 ms and frame 100 18 ms; no other deadline moves, so the mean is unchanged.
  EXPECT_NEAR(row.mean, 50, 1e-9);
  const double slow = 1 / 0.022 - 50, fast = 1 / 0.018 - 50;
  EXPECT_NEAR(row.sd, std::sqrt((slow * slow + fast * fast) / 500 - std::pow((slow + fast) / 500, 2)), 1e-9);
  const auto trials = test::trials_of(folder / "study.db");
  EXPECT_THAT(trials.at(0).trial.first.reason, testing::HasSubstr("1 late frame, the worst by 2 ms"));
}

TEST(LateFrames, SustainedLoadFailsTheTrial) {
  const test::TemporaryFolder folder;
  const CertificateRow row = certificate_of(folder / "study.db", {each_takes_25_ms});
  EXPECT_THAT(std::make_tuple(row.pass, row.degraded, row.fail), testing::FieldsAre(0, 0, 1));
  // Every interval is 25 ms but the last, which has its planned 20 ms. Frame i is 25 (i + 1) - 20 i ms late.
  EXPECT_EQ(row.late, 500);
  EXPECT_NEAR(row.worst_late_ms, 25 * 500 - 20 * 499, 1e-6);
  EXPECT_NEAR(row.mean, 500 / (499 * 0.025 + 0.020), 1e-9);
  EXPECT_NEAR(row.sd, 10 * std::sqrt(499.0) / 500, 1e-9);
  const auto trials = test::trials_of(folder / "study.db");
  EXPECT_THAT(trials.at(0).trial.first.reason, testing::HasSubstr("mean 40.02 frames/s is off by 20 %"));
}

TEST(LateFrames, ATrialThatGoesOnForTooLongIsCutAndItsQuestionAsked) {
  const test::TemporaryFolder folder;
  const CertificateRow row = certificate_of(folder / "study.db", {each_takes_250_ms});
  EXPECT_THAT(std::make_tuple(row.pass, row.degraded, row.fail), testing::FieldsAre(0, 0, 1));
  // Frame i is ready 250 i ms after the start and shown 250 ms later. The trial is cut at 20 s, so the last
  // frame is the one that is ready at 20 s.
  EXPECT_EQ(row.frames, 81);
  const auto trials = test::trials_of(folder / "study.db");
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_TRUE(trials.at(0).score().has_value());
  EXPECT_EQ(trials.at(0).trial.first.verdict, Verdict::Fail);
  EXPECT_THAT(trials.at(0).trial.first.reason, testing::HasSubstr(": 81 of 500 frames shown"));
  EXPECT_TRUE(Store(folder / "study.db", Open::Write).open_runs().empty());
}

TEST(LateFrames, APairOfWhichOneIsCutIsShownWholeAndJudged) {
  test::OneSession one(test::paced_pairs());
  VirtualClock clock;
  // Frame i is ready after i s. A showing of 1 s is cut 5 s past its end, so frame 7 is not shown.
  LateDisplay display(clock, [](std::int64_t frame) { return frame < 7 ? 1'000'000'000 : 0; });
  test::NullStimuli stimuli(one.protocol.content.content_step_s);
  const auto runs = one.open();
  run_session(one.protocol, runs.at(0).sessions.at(0),
              {clock, display, stimuli, one.person, one.store, &one.personal, true}, {});
  EXPECT_EQ(one.count("presentation WHERE verdict = 'fail'"), 1);
  EXPECT_EQ(one.count("presentation WHERE verdict = 'fail' AND reason LIKE 'cut % 7 of 20 frames shown%'"),
            1);
  EXPECT_EQ(one.count("presentation"), 2 * one.count("trial"));
  EXPECT_EQ(one.count("trial WHERE state = 'answered'"), one.count("trial"));
}

TEST(LateFrames, ACellCountsEachVerdict) {
  const test::TemporaryFolder folder;
  const CertificateRow row =
      certificate_of(folder / "study.db", {each_takes_25_ms, punctual, frame_100_is_2_ms_late, punctual});
  EXPECT_THAT(std::make_tuple(row.pass, row.degraded, row.fail), testing::FieldsAre(2, 1, 1));
  EXPECT_EQ(row.trials, 4);
  EXPECT_EQ(row.late, 501);
}

}  // namespace
}  // namespace study
