/// Whole sessions on the simulated runtime, through the real loader.
#include <gmock/gmock.h>

#include <thread>
#include <utility>

#include "libsim/gl/png.hpp"
#include "tests/headset/client.hpp"

namespace simulated {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST(SimulatedSessionGl, FramesAreWaitedForOnAThreadOfTheirOwn) {
  Client client;
  client.frames_until(focused);
  for (int i = 0; i < 20; ++i) {
    std::thread waits([&] { EXPECT_EQ(client.wait(), XR_SUCCESS); });
    waits.join();
    EXPECT_EQ(client.begin(), XR_SUCCESS);
    XrFrameState state = client.state;
    std::thread ahead([&] { EXPECT_EQ(client.wait(), XR_SUCCESS); });  // before this frame ends
    ahead.join();
    std::swap(state, client.state);
    EXPECT_EQ(client.end(), XR_SUCCESS);
    std::swap(state, client.state);
    EXPECT_EQ(client.begin(), XR_SUCCESS);
    EXPECT_EQ(client.end(), XR_SUCCESS);
  }
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
  EXPECT_THAT(client.lines("note"), IsEmpty());
}

TEST(SimulatedSessionGl, APositiveCodeIsASuccess) {
  Client client("positive=1");
  client.frames_until(focused);
  EXPECT_EQ(client.frame(), XR_SESSION_LOSS_PENDING);
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST(SimulatedSessionGl, AStarvedLoopIsNoted) {
  Client client("clock=real");
  client.frames_until(focused);
  const std::size_t before = client.lines("note").size();  // a slow machine may have caused notes
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  client.frame();
  ASSERT_GT(client.lines("note").size(), before);
  EXPECT_THAT(client.lines("note").back(), HasSubstr("starved for "));
}

TEST(SimulatedSessionGl, ResultsAndTypesHaveNames) {
  Client client;
  char text[XR_MAX_RESULT_STRING_SIZE];
  const auto name = client.call<PFN_xrResultToString>("xrResultToString");
  EXPECT_EQ(name(client.instance, XR_ERROR_POSE_INVALID, text), XR_SUCCESS);
  EXPECT_STREQ(text, "XR_ERROR_POSE_INVALID");
  name(client.instance, static_cast<XrResult>(-77), text);
  EXPECT_STREQ(text, "XR_UNKNOWN_FAILURE_-77");
}

TEST(SimulatedSessionGl, ImagesAreWrittenAsTheyAreShown) {
  Client client("dump=6,7,8");
  client.frames_until(focused);
  const auto look = [&](const std::string& name, std::array<int, 3> colour) {
    const sim::Image image = sim::read_png(client.folder() / (name + ".png"));
    EXPECT_EQ(image.width, 64);
    EXPECT_EQ(image.height, 48);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(image.rgba[i], colour[i]) << name;
  };
  while (client.lines("frame").size() < 7) frames(client, 1);
  look("000006_left", {64, 128, 191});
  client.make_swapchains(GL_RGBA16F, 2);  // with linear values, which are converted to sRGB
  frames(client, 1);
  look("000007_right", {137, 188, 225});
  const std::array<float, 4> white{1, 1, 1, 1};
  for (const auto& image : client.images[1])
    glClearTexSubImage(image.image, 0, 0, 0, 1, 64, 48, 1, GL_RGBA, GL_FLOAT, white.data());
  client.frame([](Drawing& d) { d.views[1].subImage.imageArrayIndex = 1; });
  look("000008_right", {255, 255, 255});
  EXPECT_FALSE(std::filesystem::exists(client.folder() / "000005_left.png"));
}

TEST(SimulatedSessionGl, TheLogTellsHeldImagesFromNewOnes) {
  Client client("hash=1");
  client.frames_until(focused);
  const auto hash = [&](float red) {
    client.poll();
    client.wait();
    client.begin();
    client.end([&](Drawing&) { client.draw(0, {red, 0, 0, 1}); });
    const std::string line = client.lines("frame").back();
    return line.substr(line.find("shows"));
  };
  const std::string first = hash(0.5f);
  EXPECT_EQ(hash(0.5f), first);
  EXPECT_NE(hash(0.6f), first);
}

}  // namespace
}  // namespace simulated
