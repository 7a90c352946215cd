/// HeadsetSession, which the tests call directly in place of a HeadsetDisplay: held pictures, pages, a frame
/// thread, unchanged GL state.
#include "libstudy/headset/headset_session.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <functional>
#include <future>
#include <regex>

#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HeadsetSessionGl : public test::HeadsetRuns {
 protected:
  ~HeadsetSessionGl() override { EXPECT_THAT(calls(), Not(HasSubstr("BREACH"))); }

  study::HeadsetSession& start(const std::string& profile, const study::HeadsetChoice& choice = {}) {
    use_here("size=64x48;" + profile);
    session_.emplace(gl_, choice);
    const base::PictureSize size = session_->picture_size();
    picture_ = std::make_unique<sim::Offscreen>(size.width, size.height);
    if (choice.page_width_px > 0)
      page_ = std::make_unique<sim::Offscreen>(choice.page_width_px, choice.page_height_px);
    return *session_;
  }
  /// Polls until the session runs.
  void begin_running() {
    for (int i = 0; i < 100 && !session_->running(); ++i) session_->poll();
    ASSERT_TRUE(session_->running());
  }
  /// Draws a frame and returns its layers.
  using Draw = std::function<study::HeadsetLayers(const study::HeadsetSlot&)>;
  void run_frames(int count, const Draw& draw) {
    for (int i = 0; i < count; ++i) {
      session_->poll();
      const study::HeadsetSlot slot = session_->wait();
      session_->begin(slot);
      session_->end(slot, draw(slot));
    }
  }
  void paint(const sim::Offscreen& picture, float red) const {
    const std::array<float, 4> colour{red, 0.5f, 0.25f, 1};
    glClearNamedFramebufferfv(picture.framebuffer(), GL_COLOR, 0, colour.data());
  }
  study::HeadsetLayers seen_from(const study::EyeViews& views) const {
    return {.picture = picture_.get(), .views = views};
  }
  /// Text in the log's line of one frame that matches `what`.
  std::string logged(long frame, const std::string& what) const {
    const std::string all = calls();
    std::smatch found;
    const std::regex pattern("frame " + std::to_string(frame) + " [^\n]*(" + what + ")");
    return std::regex_search(all, found, pattern) ? found[1].str() : "none";
  }

  sim::GlContext gl_ = sim::GlContext::make_headless();
  std::unique_ptr<sim::Offscreen> picture_, page_;
  std::optional<study::HeadsetSession> session_;
};

TEST_F(HeadsetSessionGl, AHeldPictureKeepsItsPoseWhileTheHeadMoves) {
  start("head=walk;dump=5,9");
  begin_running();
  std::optional<study::EyeViews> held;
  std::array<float, 3> last_place{};
  run_frames(10, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
    const study::EyeViews now = session_->views(slot);
    if (!slot.should_render) return {};
    if (!held) {
      paint(*picture_, 1);
      held = now;
    }
    last_place = now[0].pose.place_m;
    return seen_from(*held);
  });
  ASSERT_TRUE(held);
  EXPECT_NE((*held)[0].pose.place_m, last_place);
  const std::string place = "at [-.0-9]+ [-.0-9]+ [-.0-9]+ turned [-. 0-9]+";
  EXPECT_NE(logged(3, place), "none");
  EXPECT_EQ(logged(3, place), logged(9, place));
  EXPECT_EQ(picture(5, "left").rgba, picture(9, "left").rgba);
  EXPECT_EQ(picture(9, "right").rgba[0], 255);
}

TEST_F(HeadsetSessionGl, APageStandsBeforeThePictures) {
  start("dump=5,7", {.page_width_px = 40, .page_height_px = 20});
  begin_running();
  study::HeadsetPage page;
  page.pose.place_m = {0.1f, 0.2f, -1.5f};
  page.width_m = 0.8f;
  page.height_m = 0.4f;
  run_frames(8, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
    paint(*picture_, 0);
    paint(*page_, 1);
    // The last frame has only the page.
    return {.picture = slot.index < 7 ? picture_.get() : nullptr,
            .views = session_->views(slot),
            .page = page_.get(),
            .place = page};
  });
  EXPECT_EQ(logged(5, "layers [0-9]+"), "layers 2");
  EXPECT_EQ(logged(7, "layers [0-9]+"), "layers 1");
  EXPECT_THAT(logged(5, "quad [^\n]*"),
              HasSubstr("at 0.100000 0.200000 -1.500000 turned 0.000000 0.000000 0.000000 1.000000"));
  EXPECT_THAT(logged(5, "quad [^\n]*"), HasSubstr("size 0.800000 0.400000"));
  const sim::Image shown = picture(7, "quad");
  EXPECT_EQ(shown.width, 40);
  EXPECT_EQ(shown.height, 20);
  // Within one level, because GPUs round sRGB differently.
  for (const auto& [part, level] : {std::pair(0u, 255), {1u, 128}, {2u, 64}, {3u, 255}})
    EXPECT_NEAR(shown.rgba[part], level, 1);
}

TEST_F(HeadsetSessionGl, ContentThatKeepsItsNumberIsCopiedOnce) {
  start("dump=5,7");
  begin_running();
  run_frames(8, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
    paint(*picture_, slot.index < 3 ? 1 : 0);
    study::HeadsetLayers shown = seen_from(session_->views(slot));
    shown.picture_number = slot.index < 7 ? 1 : 2;
    return shown;
  });
  EXPECT_EQ(picture(5, "left").rgba[0], 255);
  EXPECT_EQ(picture(7, "right").rgba[0], 0);
}

TEST_F(HeadsetSessionGl, NothingIsHandedOverForASlotThatNobodySees) {
  start("at=4:render/0", {.page_width_px = 40, .page_height_px = 20});
  begin_running();
  study::HeadsetPage page;
  page.pose.place_m = {0, 0, -1};
  page.width_m = page.height_m = 0.5f;
  run_frames(7, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
    return {.picture = picture_.get(), .views = session_->views(slot), .page = page_.get(), .place = page};
  });
  EXPECT_EQ(logged(3, "render 1 layers [0-9]+"), "render 1 layers 2");
  EXPECT_EQ(logged(6, "render 0 layers [0-9]+"), "render 0 layers 0");
}

TEST_F(HeadsetSessionGl, FramesMayComeFromAThreadOfTheirOwn) {
  start("");
  gl_.release();
  auto frames = std::async(std::launch::async, [&] {
    gl_.make_current();
    begin_running();
    run_frames(20, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
      paint(*picture_, 1);
      return seen_from(session_->views(slot));
    });
    gl_.release();
  });
  frames.get();
  gl_.make_current();
  EXPECT_EQ(session_->state(), study::HeadsetState::Focused);
  session_.reset();
  EXPECT_THAT(calls(), HasSubstr("xrDestroyInstance"));
}

TEST_F(HeadsetSessionGl, TheCallersContextIsCurrentAfterEachCallAndWithoutErrors) {
  for (const char* leaves : {"none", "other"}) {
    start(std::string("leave_error=1;leave_context=") + leaves);
    const EGLContext own = gl_.egl().context;
    const auto expect_own = [&](const char* after) {
      EXPECT_EQ(eglGetCurrentContext(), own) << leaves << after;
      EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR)) << leaves << after;
    };
    expect_own("start");
    begin_running();
    for (int i = 0; i < 5; ++i) {
      session_->poll();
      expect_own("poll");
      const study::HeadsetSlot slot = session_->wait();
      expect_own("wait");
      session_->begin(slot);
      expect_own("begin");
      const study::EyeViews views = session_->views(slot);
      session_->input(slot);
      paint(*picture_, 1);
      session_->end(slot, seen_from(views));
      expect_own("end");
    }
    session_.reset();
    expect_own("leaving");
  }
}

TEST_F(HeadsetSessionGl, TimesThatDoNotConvertKeepTheirSteps) {
  study::HeadsetSession& session = start("without=XR_KHR_convert_timespec_time");
  EXPECT_FALSE(session.times_convert());
  begin_running();
  std::vector<std::int64_t> predicted;
  run_frames(5, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
    predicted.push_back(slot.predicted_ns);
    return {};
  });
  for (std::size_t i = 1; i < predicted.size(); ++i)
    EXPECT_NEAR(static_cast<double>(predicted[i] - predicted[i - 1]), 1e9 / 90, 2);
}

TEST_F(HeadsetSessionGl, APlaceThatIsNotTrackedIsTold) {
  study::HeadsetSession& session = start("at=4:position/0");
  begin_running();
  std::vector<bool> tracked;
  run_frames(6, [&](const study::HeadsetSlot& slot) -> study::HeadsetLayers {
    const study::HeadsetPose head = session.input(slot).head;
    EXPECT_TRUE(head.turn_tracked);
    tracked.push_back(head.place_tracked);
    return {};
  });
  EXPECT_TRUE(tracked.front());
  EXPECT_FALSE(tracked.back());
}

}  // namespace
}  // namespace apps
