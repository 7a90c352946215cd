/// vip-study run with live cells that the station cannot show, as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "libstudy/store/read/task_answers.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/small_dam.hpp"
#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class LiveRatesE2e : public ::testing::Test {
 protected:
  LiveRatesE2e() {
    const std::string scene = base::read_file(base::resource("data/scenes/faucet.toml"), 1 << 20);
    base::write_file_atomically(scene_, replaced(scene, "settle_frames = 120", "settle_frames = 1"));
  }
  /// A protocol of one trial at this frame rate.
  void write_protocol(const std::string& mean_fps, const std::string& duration_s) {
    base::write_file_atomically(protocol_,
                                with_keys(short_protocol(duration_s), {{"scene", "[\"" + scene_ + "\"]"},
                                                                       {"mean_fps", "[" + mean_fps + "]"},
                                                                       {"sd_fps", "[0]"},
                                                                       {"fps_min", "1"},
                                                                       {"max_interval_ms", "1000"},
                                                                       {"method", "[\"LoRes\"]"},
                                                                       {"n_star", "[\"64\"]"}}));
  }
  /// Asks for a thousand frames of this fluid a second, more than any machine computes.
  void write_too_fast() { write_protocol("1000", "1"); }
  /// Trials are cut as soon as their time is over, so that a trial is cut even on a machine that computes
  /// most of its frames.
  void cut_at_once() { replace_in(protocol_, "late_after_ms = 0.5 ", "overrun_s = 0\nlate_after_ms = 0.5 "); }
  std::function<void()> own_cache() {
    return [this] { ::setenv("VIP_CACHE_DIR", (folder_ / "cache").c_str(), 1); };
  }
  std::vector<std::string> live(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"--participants", "1",    "--display", "headless", "--backend", "cpu",
                                 "--clock",        clock_, "--size",    size_};
    all.insert(all.end(), more.begin(), more.end());
    return run_arguments(protocol_, database_, all);
  }
  Ended run() { return run_program(live({}), own_cache()); }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "faucet.toml", protocol_ = folder_ / "short.toml";
  std::string database_ = folder_ / "study.db", size_ = "640x360", clock_ = "real";
};

// The obstacle is a plate that closes the tank above its water and moves down into it.
TEST_F(LiveRatesE2e, ASceneWhoseObstacleLeavesTheWaterNoRoomIsRefusedBeforeAnythingIsWritten) {
  base::write_file_atomically(
      scene_, replaced(replaced(small_dam, "format = 1", "format = 2"), "max_m = [1.0,", "max_m = [2.0,") +
                  "[[obstacle]]\nshape = \"box\"\ncentre_m = [1.0, 1.5, 0.5]\nsize_m = [1.96, 1.0, 0.96]\n"
                  "motion = \"swings\"\nway_m = [0.0, -0.9, 0.0]\nperiod_s = 4.0\n");
  write_protocol("30", "0.5");
  const Ended checked = run_program({vip_study, "check", protocol_});
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.err, AllOf(HasSubstr("obstacle 1 (box)"), HasSubstr("mend: make it narrower by")));
  const Ended ran = run();
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.err, AllOf(HasSubstr("obstacle 1 (box)"), HasSubstr("mend: make it narrower by")));
  EXPECT_FALSE(fs::exists(database_));
}

TEST_F(LiveRatesE2e, CellsThatAreNotReachedAreRefusedBeforeAnythingIsWritten) {
  write_too_fast();
  const Ended first = run();
  EXPECT_EQ(first.exit_code, 1);
  EXPECT_THAT(first.err,
              AllOf(HasSubstr("measuring 1 live stimulus at 640x360, up to 5 s"),
                    HasSubstr("LoRes faucet 64"), HasSubstr("where 1000 are asked for"),
                    HasSubstr("1 of 1 live cells do not reach their setting"), HasSubstr("--accept-slow")));
  EXPECT_FALSE(fs::exists(database_));
  const Ended again = run();
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, AllOf(HasSubstr("where 1000 are asked for"), HasSubstr("they are measured again")));
  EXPECT_FALSE(fs::exists(database_));
}

TEST_F(LiveRatesE2e, TheyArePlayedWhereThatIsAcceptedAlsoByResumeAndCutWithTheirAnswersKept) {
  write_too_fast();
  cut_at_once();
  Process stopped(live({"--accept-slow"}), own_cache());
  for (auto line = stopped.read_line(); line && line->find(" stimulus ") == std::string::npos;)
    line = stopped.read_line();
  stopped.send(SIGINT);
  EXPECT_THAT(stopped.wait().err, HasSubstr("continue with vip-study resume"));
  const Ended resumed = run_program({vip_study, "resume", "--db", database_}, own_cache());
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, Not(HasSubstr("measuring")));
  // The first showing may have reached its own cut in the frame in which it was stopped; it never counts.
  EXPECT_EQ(
      count_in(database_,
               "SELECT count(*) FROM presentation JOIN showing USING (presentation_id) WHERE counts AND "
               "state = 'played' AND verdict = 'fail' AND reason LIKE 'cut %frames shown%'"),
      1);
  EXPECT_EQ(count_in(database_,
                     "SELECT count(*) FROM response JOIN unit USING (unit_id) WHERE trial_id IS NOT NULL"),
            1);
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM showing WHERE counts"), 1);
  EXPECT_EQ(count_in(database_,
                     "SELECT count(*) FROM event WHERE kind = 'live rates' AND detail LIKE "
                     "'%LoRes faucet 64%'"),
            2);
}

TEST_F(LiveRatesE2e, WhatIsReachedIsToldAndPlayed) {
  write_protocol("1", "2");
  size_ = "64x36";
  const Ended ended = run();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("live on this station"), HasSubstr("(1, 0)")));
  // The cost of the session's frames is in the database, and read_tasks() returns it.
  const auto session = study::read_tasks(database_).protocols.at(0).sessions.at(0);
  ASSERT_EQ(session.frame_costs.size(), 1u);
  EXPECT_EQ(session.frame_costs[0].what, (study::StimulusSpec{scene_, "LoRes", "64"}));
  EXPECT_GT(session.frame_costs[0].mean_ms, 0);
}

TEST_F(LiveRatesE2e, OnAVirtualClockNothingCostsAnything) {
  write_protocol("1", "2");
  size_ = "64x36";
  clock_ = "virtual";
  ASSERT_EQ(run().exit_code, 0);
  EXPECT_TRUE(study::read_tasks(database_).protocols.at(0).sessions.at(0).frame_costs.empty());
}

TEST_F(LiveRatesE2e, CheckMeasuresForTheSessionsOfItsSize) {
  write_protocol("1", "2");
  size_ = "64x36";
  const auto check = [&] {
    return run_program({vip_study, "check", protocol_, "--refresh", "90", "--measure", "--backend", "cpu",
                        "--size", size_, "--json", folder_ / "check.json"},
                       own_cache());
  };
  const Ended checked = check();
  ASSERT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("measured here:"));
  const auto json = base::Json::parse(base::read_file(folder_ / "check.json", 1 << 20));
  EXPECT_EQ(json.at("measured").at(0).at("asked_mean_fps"), 1);
  EXPECT_GT(json.at("measured").at(0).at("fps_mean"), 0);
  EXPECT_THAT(run().err, AllOf(HasSubstr("live on this station"), Not(HasSubstr("measuring"))));
  EXPECT_THAT(check().err, HasSubstr("measuring")) << "check measures anew";
}

TEST_F(LiveRatesE2e, ASessionWithoutWaitingIsNotMeasured) {
  write_protocol("1000", "0.1");
  clock_ = "virtual", size_ = "64x36";
  const Ended ended = run();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, Not(HasSubstr("live on this station")));
}

}  // namespace
}  // namespace apps::test
