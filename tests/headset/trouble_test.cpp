/// How a program notices the faults that a profile makes the runtime have: events, results of calls, times,
/// and GL state.
#include <gmock/gmock.h>

#include <thread>

#include "tests/headset/client.hpp"
#include "tests/headset/pose.hpp"

namespace simulated {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr XrDuration period = 11111111;  // ns at 90 Hz

class TroubleGl : public ::testing::Test {
 protected:
  /// Runs that many frames; returns the predicted time of each.
  std::vector<XrTime> frames(Client& client, std::size_t count) {
    std::vector<XrTime> out;
    while (out.size() < count && client.frame() == XR_SUCCESS)
      out.push_back(client.state.predictedDisplayTime);
    client.poll();
    EXPECT_THAT(client.lines("BREACH"), IsEmpty());
    return out;
  }
  std::vector<long> steps(const std::vector<XrTime>& times) {
    std::vector<long> out;
    for (std::size_t i = 1; i < times.size(); ++i) out.push_back((times[i] - times[i - 1]) / period);
    return out;
  }
};

TEST_F(TroubleGl, FocusIsLostAndComesBack) {
  Client client("at=5:focus/0,8:focus/1,10:shown/0,12:shown/1");
  frames(client, 20);
  constexpr auto synchronized = XR_SESSION_STATE_SYNCHRONIZED, visible = XR_SESSION_STATE_VISIBLE,
                 focused = XR_SESSION_STATE_FOCUSED;
  EXPECT_THAT(client.states, ElementsAre(XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY, synchronized, visible,
                                         focused, visible, focused, visible, synchronized, visible, focused));
}

TEST_F(TroubleGl, SessionIsLostAndMadeAgain) {
  Client client("at=6:lost/3");
  EXPECT_THAT(frames(client, 6), SizeIs(6));
  EXPECT_EQ(client.frame(), XR_SESSION_LOSS_PENDING);
  client.poll();
  EXPECT_EQ(client.session_state, XR_SESSION_STATE_LOSS_PENDING);
  XrResult result = XR_SUCCESS;
  for (int i = 0; i < 5 && XR_SUCCEEDED(result); ++i) result = client.frame();
  EXPECT_EQ(result, XR_ERROR_SESSION_LOST);
  client.call<PFN_xrDestroySession>("xrDestroySession")(client.session);
  client.make_session();
  client.make_swapchains();
  client.frames_until(XR_SESSION_STATE_FOCUSED);
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
}

TEST_F(TroubleGl, SessionIsLostAtOnce) {
  Client client("at=6:lost_now");
  frames(client, 6);
  EXPECT_EQ(client.frame(), XR_ERROR_SESSION_LOST);
}

TEST_F(TroubleGl, InstanceIsLost) {
  Client client("at=6:instance_lost/2");
  frames(client, 7);
  ASSERT_THAT(client.events, SizeIs(1));
  EXPECT_EQ(client.events[0].type, XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING);
  EXPECT_EQ(client.frame(), XR_ERROR_INSTANCE_LOST);
}

TEST_F(TroubleGl, UserEndsTheProgram) {
  Client client("at=6:exit");
  frames(client, 20);
  EXPECT_EQ(client.session_state, XR_SESSION_STATE_EXITING);
}

TEST_F(TroubleGl, EventsThatNobodyExpects) {
  Client client("at=4:unknown,5:events_lost/7,6:recentre/30");
  frames(client, 10);
  ASSERT_THAT(client.events, SizeIs(3));
  EXPECT_EQ(client.events[0].type, 1'999'999'999);
  EXPECT_EQ(reinterpret_cast<const XrEventDataEventsLost&>(client.events[1]).lostEventCount, 7u);
  EXPECT_EQ(client.events[2].type, XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING);
  const XrSpace stage = client.make_space(XR_REFERENCE_SPACE_TYPE_STAGE);
  const XrPosef local = client.locate(client.local, stage, client.state.predictedDisplayTime).pose;
  EXPECT_NEAR(local.orientation.y, std::sin(15 * radians_per_degree), 1e-6);
}

TEST_F(TroubleGl, ARecentringMayComeIntoForceLater) {
  Client client("at=4:recentre/30;recentre_lead=0.1");
  const auto yaw_at = [&](XrTime time) {
    return 2 *
           std::asin(client.locate(client.local, client.make_space(XR_REFERENCE_SPACE_TYPE_STAGE), time)
                         .pose.orientation.y) /
           radians_per_degree;
  };
  frames(client, 6);
  ASSERT_THAT(client.events, SizeIs(1));
  const XrTime change =
      reinterpret_cast<const XrEventDataReferenceSpaceChangePending&>(client.events[0]).changeTime;
  EXPECT_GT(change, client.state.predictedDisplayTime);
  EXPECT_NEAR(yaw_at(change - 1), 0, 1e-4);
  EXPECT_NEAR(yaw_at(change), 30, 1e-4);
}

TEST_F(TroubleGl, SlotsAreLeftOutAndPredictedTwice) {
  Client client("at=4:drop/3,6:repeat");
  EXPECT_THAT(steps(frames(client, 9)), ElementsAre(1, 1, 1, 4, 1, 0, 2, 1));
}

TEST_F(TroubleGl, PredictedTimesLeaveTheGrid) {
  Client client("jitter=3");
  const auto times = frames(client, 20);
  int off = 0;
  for (const XrTime time : times) {
    const XrDuration error = (time - times[0]) % period;
    off += std::min(error, period - error) > 100'000;
    EXPECT_TRUE(error < 6'000'000 || period - error < 6'000'000) << error;
  }
  EXPECT_GT(off, 10);
}

TEST_F(TroubleGl, TheFirstPeriodsAreWrong) {
  Client client("wrong_periods=5");
  frames(client, 5);
  EXPECT_EQ(client.state.predictedDisplayPeriod, 3 * period);
  frames(client, 1);
  EXPECT_EQ(client.state.predictedDisplayPeriod, period);
}

TEST_F(TroubleGl, TheRateIsAskedForOrChangesOfItself) {
  Client client("at=10:rate/72");
  const auto request = client.call<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB");
  EXPECT_EQ(request(client.session, 120), XR_SUCCESS);
  frames(client, 5);
  EXPECT_EQ(client.state.predictedDisplayPeriod, 8333333);
  frames(client, 8);
  EXPECT_EQ(client.state.predictedDisplayPeriod, 13888889);
  ASSERT_THAT(client.events, SizeIs(2));
  const auto& change = reinterpret_cast<const XrEventDataDisplayRefreshRateChangedFB&>(client.events[1]);
  EXPECT_EQ(change.fromDisplayRefreshRate, 120);
  EXPECT_EQ(change.toDisplayRefreshRate, 72);
}

TEST_F(TroubleGl, ARateMayBeIgnored) {
  Client client("ignores_rate=1");
  EXPECT_EQ(
      client.call<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB")(client.session, 120),
      XR_SUCCESS);
  frames(client, 5);
  EXPECT_EQ(client.state.predictedDisplayPeriod, period);
  EXPECT_THAT(client.events, IsEmpty());
}

TEST_F(TroubleGl, AWaitThatHangsHoldsUpNobodyElse) {
  Client client("at=4:hang/0.5");
  frames(client, 4);
  client.poll();
  bool done = false;
  std::thread waits([&] {
    client.wait();
    done = true;
  });
  client.poll();
  const bool polled_first = !done;
  waits.join();
  EXPECT_TRUE(polled_first);
}

TEST_F(TroubleGl, TimesConvertToAnotherClock) {
  Client client;
  frames(client, 2);
  timespec time{};
  XrTime back = 0;
  const XrTime predicted = client.state.predictedDisplayTime;
  ASSERT_EQ(client.call<PFN_xrConvertTimeToTimespecTimeKHR>("xrConvertTimeToTimespecTimeKHR")(
                client.instance, predicted, &time),
            XR_SUCCESS);
  ASSERT_EQ(client.call<PFN_xrConvertTimespecTimeToTimeKHR>("xrConvertTimespecTimeToTimeKHR")(client.instance,
                                                                                              &time, &back),
            XR_SUCCESS);
  EXPECT_EQ(back, predicted);
  EXPECT_NE(time.tv_sec, predicted / 1'000'000'000);
}

TEST_F(TroubleGl, TheContextIsChangedAndAnErrorLeft) {
  Client client("leave_context=other;leave_error=1");
  frames(client, 1);
  EXPECT_NE(eglGetCurrentContext(), EGL_NO_CONTEXT);
  EXPECT_NE(eglGetCurrentContext(), client.gl->egl().context);
  client.gl->make_current();
  EXPECT_NE(glGetError(), GLenum{GL_NO_ERROR});
}

TEST_F(TroubleGl, NoContextIsLeft) {
  Client client("leave_context=none");
  frames(client, 1);
  EXPECT_EQ(eglGetCurrentContext(), EGL_NO_CONTEXT);
}

TEST_F(TroubleGl, AListedFormatCannotBeMade) {
  Client client("formats=rgb10_a2,srgb8_alpha8;broken=rgb10_a2");
  EXPECT_THROW(client.make_swapchains(GL_RGB10_A2), std::runtime_error);
  EXPECT_THAT(frames(client, 5), SizeIs(5));
}

TEST_F(TroubleGl, ImagesComeLate) {
  Client client("image_timeouts=3");
  EXPECT_THAT(frames(client, 5), SizeIs(5));
}

TEST_F(TroubleGl, RealTimeIsKept) {
  Client client("clock=real;rate=120;rates=120");
  const auto times = frames(client, 30);
  ASSERT_THAT(times, SizeIs(30));
  for (std::size_t i = 1; i < times.size(); ++i) {
    EXPECT_GT(times[i], times[i - 1]);
    EXPECT_EQ((times[i] - times[0]) % 8333333, 0) << "off the grid";
  }
}

}  // namespace
}  // namespace simulated
