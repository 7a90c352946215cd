/// Programs that break the specification, each in one way: the runtime reports it and returns the code that
/// the specification names.
#include <gmock/gmock.h>

#include <future>
#include <thread>

#include "tests/headset/client.hpp"

namespace simulated {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BreachGl : public ::testing::Test {
 protected:
  void SetUp() override { client.frames_until(XR_SESSION_STATE_FOCUSED); }
  void TearDown() override { EXPECT_THAT(client.lines("BREACH"), ElementsAre("BREACH " + expected)); }

  /// Runs a frame with one fault.
  void spoilt(const Spoil& spoil, XrResult result, const std::string& text) {
    EXPECT_EQ(client.frame(spoil), result);
    expected = "xrEndFrame: " + text;
  }
  XrResult begin_session() {
    auto info = blank<XrSessionBeginInfo>(XR_TYPE_SESSION_BEGIN_INFO);
    info.primaryViewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    return client.call<PFN_xrBeginSession>("xrBeginSession")(client.session, &info);
  }

  Client client{"patience=0.05"};
  std::string expected;
};

TEST_F(BreachGl, DisplayTimeZero) {
  spoilt([](Drawing& d) { d.end.displayTime = 0; }, XR_ERROR_TIME_INVALID,
         "a displayTime that is not positive");
}

TEST_F(BreachGl, OneView) {
  spoilt([](Drawing& d) { d.projection.viewCount = 1; }, XR_ERROR_VALIDATION_FAILURE,
         "another number of views than was located");
}

TEST_F(BreachGl, SwappedEyes) {
  spoilt([](Drawing& d) { std::swap(d.views[0], d.views[1]); }, XR_ERROR_VALIDATION_FAILURE,
         "the eyes' poses are swapped");
}

TEST_F(BreachGl, SwappedFieldsOfView) {
  spoilt([](Drawing& d) { std::swap(d.views[0].fov, d.views[1].fov); }, XR_ERROR_VALIDATION_FAILURE,
         "the eyes' fields of view are swapped");
}

TEST_F(BreachGl, ZeroQuaternion) {
  spoilt(
      [](Drawing& d) {
        d.views[1].pose.orientation = {0, 0, 0, 0};
      },
      XR_ERROR_POSE_INVALID, "a pose that is none");
}

TEST_F(BreachGl, RectangleLargerThanTheImage) {
  spoilt([](Drawing& d) { d.views[0].subImage.imageRect.extent.width += 1; }, XR_ERROR_SWAPCHAIN_RECT_INVALID,
         "a rectangle that leaves the image");
}

TEST_F(BreachGl, NoSuchSlice) {
  spoilt([](Drawing& d) { d.views[0].subImage.imageArrayIndex = 1; }, XR_ERROR_VALIDATION_FAILURE,
         "an index beyond the array of the image");
}

TEST_F(BreachGl, EmptyFieldOfView) {
  spoilt([](Drawing& d) { d.views[0].fov = {}; }, XR_ERROR_VALIDATION_FAILURE,
         "a field of view that is empty");
}

TEST_F(BreachGl, FlippedFieldOfView) {
  spoilt([](Drawing& d) { std::swap(d.views[0].fov.angleUp, d.views[0].fov.angleDown); }, XR_SUCCESS,
         "a field of view that is flipped");
}

TEST_F(BreachGl, FieldOfViewInDegrees) {
  spoilt([](Drawing& d) { d.views[0].fov.angleRight = 42; }, XR_ERROR_VALIDATION_FAILURE,
         "a field of view beyond 90 degrees");
}

TEST_F(BreachGl, WrongType) {
  spoilt([](Drawing& d) { d.end.type = XR_TYPE_FRAME_BEGIN_INFO; }, XR_ERROR_VALIDATION_FAILURE,
         "a structure of another type, or none");
}

TEST_F(BreachGl, ChainOfAnExtensionThatIsNotEnabled) {
  auto depth = blank<XrCompositionLayerDepthInfoKHR>(XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR);
  spoilt([&](Drawing& d) { d.views[0].next = &depth; }, XR_ERROR_VALIDATION_FAILURE,
         "a chained structure of an extension that is not enabled");
}

TEST_F(BreachGl, LayerOfNoKind) {
  spoilt([](Drawing& d) { d.projection.type = XR_TYPE_COMPOSITION_LAYER_CUBE_KHR; }, XR_ERROR_LAYER_INVALID,
         "a layer of a kind that is not offered");
}

TEST_F(BreachGl, BlendModeThatIsNotListed) {
  spoilt([](Drawing& d) { d.end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND; },
         XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED, "a blend mode that is not listed");
}

TEST_F(BreachGl, StaleSwapchain) {
  const XrSwapchain stale = client.swapchains[0];
  client.make_swapchains();
  client.call<PFN_xrDestroySwapchain>("xrDestroySwapchain")(stale);
  spoilt([&](Drawing& d) { d.views[0].subImage.swapchain = stale; }, XR_ERROR_HANDLE_INVALID,
         "the swapchain is not alive");
}

TEST_F(BreachGl, StaleSpace) {
  const XrSpace stale = client.make_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
  client.call<PFN_xrDestroySpace>("xrDestroySpace")(stale);
  spoilt([&](Drawing& d) { d.projection.space = stale; }, XR_ERROR_HANDLE_INVALID, "the space is not alive");
}

TEST_F(BreachGl, StaleSession) {
  const XrSession stale = client.session;
  client.call<PFN_xrDestroySession>("xrDestroySession")(stale);
  EXPECT_EQ(client.wait(), XR_ERROR_HANDLE_INVALID);
  client.session = XR_NULL_HANDLE;
  expected = "xrWaitFrame: the session is not alive";
}

TEST_F(BreachGl, ImageThatWasNotReleased) {
  client.make_swapchains();
  std::uint32_t index = 0;
  client.call<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage")(client.swapchains[0], nullptr, &index);
  client.poll();
  client.wait();
  client.begin();
  client.state.shouldRender = XR_FALSE;  // end() then draws no images
  EXPECT_EQ(client.end([](Drawing& d) {
    d.layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&d.projection));
  }),
            XR_ERROR_LAYER_INVALID);
  expected = "xrEndFrame: a swapchain of which no image was released";
}

TEST_F(BreachGl, ImageThatWasNotWaitedFor) {
  std::uint32_t index = 0;
  client.call<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage")(client.swapchains[0], nullptr, &index);
  EXPECT_EQ(
      client.call<PFN_xrReleaseSwapchainImage>("xrReleaseSwapchainImage")(client.swapchains[0], nullptr),
      XR_ERROR_CALL_ORDER_INVALID);
  expected = "xrReleaseSwapchainImage: no image was waited for";
}

TEST_F(BreachGl, ImagesThatAreNeverReleased) {
  std::uint32_t index = 0;
  const auto acquire = client.call<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(acquire(client.swapchains[0], nullptr, &index), XR_SUCCESS);
  EXPECT_EQ(acquire(client.swapchains[0], nullptr, &index), XR_ERROR_CALL_ORDER_INVALID);
  expected = "xrAcquireSwapchainImage: every image is acquired and none released";
}

TEST_F(BreachGl, FrameThatWasNotBegun) {
  client.wait();
  client.state.shouldRender = XR_FALSE;
  EXPECT_EQ(client.end(), XR_ERROR_CALL_ORDER_INVALID);
  expected = "xrEndFrame: no frame was begun";
}

TEST_F(BreachGl, SecondWaitBeforeTheFrameBegan) {
  client.wait();
  EXPECT_EQ(client.wait(), XR_ERROR_CALL_ORDER_INVALID);
  expected = "xrWaitFrame: the frame before was never begun";
}

TEST_F(BreachGl, FrameThatWasNotWaitedFor) {
  EXPECT_EQ(client.begin(), XR_ERROR_CALL_ORDER_INVALID);
  expected = "xrBeginFrame: no frame was waited for";
}

TEST_F(BreachGl, ContextThatIsCurrentOnAnotherThread) {
  client.wait();
  client.begin();
  client.gl->release();
  std::promise<void> taken, done;
  std::thread holder([&] {
    client.gl->make_current();
    taken.set_value();
    done.get_future().wait();
    client.gl->release();
  });
  taken.get_future().wait();
  std::uint32_t index = 0;
  const auto acquire = client.call<PFN_xrAcquireSwapchainImage>("xrAcquireSwapchainImage");
  EXPECT_EQ(acquire(client.swapchains[0], nullptr, &index), XR_ERROR_RUNTIME_FAILURE);
  done.set_value();
  holder.join();
  expected =
      "xrAcquireSwapchainImage: the session's context cannot be made current: another thread holds it, "
      "or it is gone";
}

TEST_F(BreachGl, SessionThatRunsIsBegun) {
  EXPECT_EQ(begin_session(), XR_ERROR_SESSION_RUNNING);
  expected = "xrBeginSession: the session runs already";
}

TEST_F(BreachGl, SessionThatIsNotStoppingIsEnded) {
  EXPECT_EQ(client.call<PFN_xrEndSession>("xrEndSession")(client.session), XR_ERROR_SESSION_NOT_STOPPING);
  expected = "xrEndSession: the session is not stopping";
}

TEST_F(BreachGl, FrameOfASessionThatDoesNotRun) {
  client.call<PFN_xrRequestExitSession>("xrRequestExitSession")(client.session);
  client.poll();
  EXPECT_EQ(client.wait(), XR_ERROR_SESSION_NOT_RUNNING);
  expected = "xrWaitFrame: the session does not run";
}

TEST_F(BreachGl, EventBufferThatIsNotResetted) {
  auto event = blank<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED);
  EXPECT_EQ(client.call<PFN_xrPollEvent>("xrPollEvent")(client.instance, &event),
            XR_ERROR_VALIDATION_FAILURE);
  expected = "xrPollEvent: a structure of another type, or none";
}

TEST_F(BreachGl, SwapchainOfAFormatThatIsNotListed) {
  EXPECT_THROW(client.make_swapchains(GL_RGBA4), std::runtime_error);
  expected = "xrCreateSwapchain: a format that is not listed";
}

TEST_F(BreachGl, RateThatIsNotListed) {
  const auto request = client.call<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB");
  EXPECT_EQ(request(client.session, 75), XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB);
  expected = "xrRequestDisplayRefreshRateFB: a rate that is not listed";
}

// Use that is suspicious but allowed is logged as a note, not as a breach.
TEST(NoteGl, WhatTheSpecificationAllows) {
  Client client("at=5:render/0");
  client.frames_until(XR_SESSION_STATE_FOCUSED);
  const auto layers_in_any_case = [](Drawing& d) {
    d.layers = {reinterpret_cast<const XrCompositionLayerBaseHeader*>(&d.projection)};
  };
  while (client.state.shouldRender) EXPECT_EQ(client.frame(layers_in_any_case), XR_SUCCESS);
  client.wait();
  client.begin();
  client.wait();
  EXPECT_EQ(client.begin(), XR_FRAME_DISCARDED);
  EXPECT_THAT(client.lines("BREACH"), IsEmpty());
  EXPECT_THAT(client.lines("note"),
              ElementsAre("note xrEndFrame: layers although shouldRender was false (allowed)",
                          HasSubstr("note xrBeginFrame: frame 6 was never ended")));
}

}  // namespace
}  // namespace simulated
