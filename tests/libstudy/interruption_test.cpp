#include "libstudy/session/interruptions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/error.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using test::OneSession;
using test::paced_pairs;

/// Stops the program in the sixth frame of the `showing`-th stimulus.
SessionHooks stop_in_showing(int showing) {
  auto seen = std::make_shared<int>(0);
  auto now = std::make_shared<bool>(false);
  SessionHooks hooks;
  hooks.shown = [=](const FrameRecord& frame) {
    if (frame.index == 0) ++*seen;
    *now = *seen == showing && frame.index == 5;
  };
  hooks.request = [now] { return *now ? Request::Stop : Request::GoOn; };
  return hooks;
}

/// A session of paced_pairs(): one practice trial and three that count, each with two stimuli. It is cut in
/// the fifth showing, which is in the third trial.
class InterruptionPolicy : public ::testing::Test {
 protected:
  /// Cuts the session, applies on_interruption as vip-study resume does, and plays the session to its end.
  void cut_and_resume(const std::string& policy) {
    one = std::make_unique<OneSession>(paced_pairs(policy));
    EXPECT_THROW(one->run(stop_in_showing(5)), Stopped);
    changed = settle_interruption(one->store, one->protocol, one->open().at(0).sessions.at(0));
    one->person.seen.clear();
    one->run();
    EXPECT_EQ(one->row().state, "done");
  }
  std::int64_t times_asked(const std::string& question) const {
    return std::count(one->person.seen.begin(), one->person.seen.end(), "ask " + question);
  }

  std::unique_ptr<OneSession> one;
  bool changed = false;
};

TEST_F(InterruptionPolicy, ResumeShowsTheCutTrialAgain) {
  cut_and_resume("");
  EXPECT_FALSE(changed);
  EXPECT_EQ(times_asked("preference"), 2);
  EXPECT_EQ(one->count("response JOIN question USING (question_id) WHERE code = 'ease'"), 4);
  EXPECT_EQ(one->count("presentation WHERE state = 'interrupted'"), 1);
  EXPECT_EQ(one->count("presentation WHERE state = 'played'"), 8);
}

TEST_F(InterruptionPolicy, RestartBlockShowsItsTrialsFromTheFirst) {
  cut_and_resume("restart_block");
  EXPECT_TRUE(changed);
  EXPECT_EQ(times_asked("preference"), 3) << "practice is another block";
  // The answer from before the interruption stays in the database, but is set aside.
  EXPECT_EQ(one->count("response JOIN question USING (question_id) WHERE code = 'ease'"), 5);
  EXPECT_EQ(one->count("note WHERE words LIKE 'block restarted%'"), 1);
  EXPECT_EQ(
      one->count("response r JOIN unit USING (unit_id) JOIN trial t USING (trial_id) JOIN question USING "
                 "(question_id) WHERE code = 'ease' AND r.attempt > t.set_aside"),
      4);
}

TEST_F(InterruptionPolicy, InvalidateLeavesTheCutTrialOut) {
  cut_and_resume("invalidate");
  EXPECT_TRUE(changed);
  EXPECT_EQ(times_asked("preference"), 1);
  EXPECT_EQ(one->count("trial WHERE excluded = 'interrupted' AND state = 'planned'"), 1);
  EXPECT_EQ(one->count("presentation WHERE state = 'interrupted'"), 1);
  EXPECT_EQ(one->count("response JOIN question USING (question_id) WHERE code = 'ease'"), 3);
}

TEST_F(InterruptionPolicy, IsAppliedOnce) {
  cut_and_resume("restart_block");
  EXPECT_TRUE(one->open().empty());
  OneSession other(paced_pairs("restart_block"));
  EXPECT_THROW(other.run(stop_in_showing(5)), Stopped);
  EXPECT_TRUE(settle_interruption(other.store, other.protocol, other.open().at(0).sessions.at(0)));
  EXPECT_FALSE(settle_interruption(other.store, other.protocol, other.open().at(0).sessions.at(0)));
}

TEST(Interruption, InTheLastTrialInvalidateEndsWithWhatFollows) {
  OneSession one(paced_pairs("invalidate"));
  EXPECT_THROW(one.run(stop_in_showing(8)), Stopped);
  EXPECT_TRUE(settle_interruption(one.store, one.protocol, one.open().at(0).sessions.at(0)));
  one.person.seen.clear();
  one.run();
  EXPECT_THAT(one.person.seen, ::testing::ElementsAre("ask remarks"));
  EXPECT_EQ(one.row().state, "done");
}

TEST(Interruption, AnUnknownPolicyIsRefusedWithItsPlace) {
  try {
    paced_pairs("forget");
    FAIL();
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("on_interruption"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("pairs.toml:"));
  }
}

}  // namespace
}  // namespace study
