/// Whole sessions on the simulated runtime, through the real loader.
#include <gmock/gmock.h>

#include "tests/headset/client.hpp"

namespace simulated {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr auto idle = XR_SESSION_STATE_IDLE, ready = XR_SESSION_STATE_READY,
               synchronized = XR_SESSION_STATE_SYNCHRONIZED, visible = XR_SESSION_STATE_VISIBLE,
               focused = XR_SESSION_STATE_FOCUSED, stopping = XR_SESSION_STATE_STOPPING,
               exiting = XR_SESSION_STATE_EXITING;

void frames(Client& client, int count) {
  for (int i = 0; i < count; ++i) ASSERT_EQ(client.frame(), XR_SUCCESS) << i << "\n" << client.log();
}

TEST(SimulatedSessionGl, ACorrectProgramGoesThroughAllStatesWithoutABreach) {
  Client client;
  client.frames_until(focused);
  frames(client, 20);
  client.call<PFN_xrRequestExitSession>("xrRequestExitSession")(client.session);
  client.poll();
  EXPECT_THAT(client.states, ElementsAre(idle, ready, synchronized, visible, focused, visible, synchronized,
                                         stopping, idle, exiting));
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
  EXPECT_THAT(client.lines("note"), IsEmpty());
}

TEST(SimulatedSessionGl, VirtualTimeMovesByOnePeriodAFrame) {
  Client client("rate=72");
  client.frames_until(focused);
  frames(client, 1);
  const XrTime first = client.state.predictedDisplayTime;
  EXPECT_EQ(client.state.predictedDisplayPeriod, 13888889);
  frames(client, 10);
  EXPECT_EQ(client.state.predictedDisplayTime - first, 10 * 13888889);
}

TEST(SimulatedSessionGl, TwoRunsWriteTheSameLog) {
  const auto run = [] {
    Client client("head=walk;hash=1;at=8:drop/2,10:jitter/3,15:focus/0,20:focus/1,22:off/0.2");
    for (int i = 0; i < 80; ++i) client.frame();
    return client.log();
  };
  const std::string first = run();
  EXPECT_THAT(first, HasSubstr("frame 40 "));
  EXPECT_EQ(first, run());
}

TEST(SimulatedSessionGl, TheHeadsetIsTakenOffAndPutOnAgain) {
  Client client("at=10:off/0.5");
  frames(client, 11);
  client.poll();
  EXPECT_EQ(client.session_state, idle);
  EXPECT_FALSE(client.running);
  for (int i = 0; i < 100 && !client.running; ++i) client.poll();
  client.states.clear();
  client.frames_until(focused);
  EXPECT_THAT(client.states, ElementsAre(synchronized, visible, focused));
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(SimulatedSessionGl, ImagesAreWrittenAsTheyWereShown) {
  Client client("dump=6;hash=1");
  frames(client, 8);
  for (const char* name : {"000006_left.png", "000006_right.png"})
    EXPECT_TRUE(std::filesystem::exists(client.folder() / name)) << name;
  EXPECT_FALSE(std::filesystem::exists(client.folder() / "000005_left.png"));
}

}  // namespace
}  // namespace simulated
