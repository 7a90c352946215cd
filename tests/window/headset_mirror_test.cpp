/// The experimenter's mirror window of a headset, and windows in general, on a virtual screen.
#include "libstudy/window/headset_mirror.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <sstream>
#include <thread>

#include "libstudy/headset/mirror_picture.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "libstudy/window/glfw_window.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/apps/study_test_support.hpp"

// Xlib.h defines macros such as None and Status, so X headers come last. x_screen.hpp undefines some of them.
#include <X11/Xutil.h>

#include "tests/headset/x_screen.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using Colour = std::array<int, 3>;
constexpr Colour black{0, 0, 0}, yellow{255, 255, 0}, red{255, 0, 0}, blue{0, 0, 255};

/// Red for the left eye, blue for the right one.
class TwoColours final : public study::Stimulus {
 public:
  std::string description() const override { return "two colours"; }
  std::int64_t length() const override { return 0; }
  void start(std::int64_t) override {}
  study::FrameFacts prepare(std::int64_t) override { return {}; }
  void draw(const study::Canvas& canvas) override {
    glEnable(GL_SCISSOR_TEST);
    for (const study::EyeView& eye : canvas.eyes) {
      const bool left = eye.x_px == 0;
      const std::array<float, 4> colour{left ? 1.0F : 0.0F, 0, left ? 0.0F : 1.0F, 1};
      glScissor(eye.x_px, eye.y_px, eye.width_px, eye.height_px);
      glClearNamedFramebufferfv(canvas.framebuffer, GL_COLOR, 0, colour.data());
    }
    glDisable(GL_SCISSOR_TEST);
  }
};

class HeadsetMirrorGl : public test::HeadsetRuns {
 protected:
  static constexpr int side = study::MirrorPicture::side_px;

  HeadsetMirrorGl() {
    glXMakeCurrent(screen_.binding().xDisplay, 0, nullptr);  // the headset has a context of its own
    ::setenv("DISPLAY", screen_.name().c_str(), 1);
  }
  ~HeadsetMirrorGl() override {
    ::unsetenv("DISPLAY");
    EXPECT_THAT(calls(), Not(HasSubstr("BREACH")));
  }

  /// Opens the headset's display at 20 Hz, so slow that a busy machine misses no slots.
  study::HeadsetDisplay& start(const std::string& profile = "") {
    use_here("size=32x32;clock=real;rates=20;rate=20;" + profile);
    display_.emplace(study::SlotDrive::Thread,
                     study::HeadsetChoice{.page_width_px = 64, .page_height_px = 64});
    return *display_;
  }
  void open(bool reveal) { mirror_.emplace(*display_, reveal); }
  void close() {
    mirror_.reset();
    display_.reset();
  }

  /// Shows a yellow page of 20 degrees straight ahead of the head.
  void show_page() {
    study::HeadsetDisplay& display = *display_;
    const sim::Offscreen& page = display.page();
    constexpr std::array<float, 4> colour{1, 1, 0, 1};
    glClearNamedFramebufferfv(page.framebuffer(), GL_COLOR, 0, colour.data());
    study::HeadsetPage place;
    for (int i = 0; i < 50 && !place.pose.valid(); ++i) {
      for (const study::HeadsetRecord& record : display.next_records()) place.pose = record.input.head;
    }
    place.pose.place_m[2] -= 2;  // the head looks along -z
    place.width_m = place.height_m = 2 * 2 * 0.17633F;
    display.show_page(place);
  }
  void show_stimulus() {
    study::HeadsetClock clock(*display_);
    display_->render(stimulus_);
    display_->present(display_->first_onset(clock.now_ns()), clock);
  }

  /// Colour at a place in the mirror; x and y are fractions from its left and its top.
  Colour pixel(double x, double y) const {
    ::Display* const display = screen_.binding().xDisplay;
    const int at_x = static_cast<int>(x * side), at_y = static_cast<int>(y * side);
    XImage* const image =
        XGetImage(display, DefaultRootWindow(display), at_x, at_y, 1, 1, AllPlanes, ZPixmap);
    const unsigned long value = XGetPixel(image, 0, 0);
    XDestroyImage(image);
    return {static_cast<int>(value >> 16 & 255), static_cast<int>(value >> 8 & 255),
            static_cast<int>(value & 255)};
  }
  /// Runs the headset's frame slots until the mirror shows `wanted` at (x, y), for at most 10 s. Returns the
  /// last colour there.
  Colour comes_to(const Colour& wanted, double x, double y) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    Colour found = pixel(x, y);
    while (found != wanted && std::chrono::steady_clock::now() < until) {
      display_->turn();
      found = pixel(x, y);
    }
    return found;
  }
  int count(const std::string& word) const {
    int found = 0;
    std::istringstream lines(calls());
    for (std::string line; std::getline(lines, line);) found += line.find(word) != std::string::npos;
    return found;
  }

  const simulated::XScreen screen_{std::to_string(side) + "x" + std::to_string(side)};
  std::optional<study::HeadsetDisplay> display_;
  std::optional<study::HeadsetMirror> mirror_;
  TwoColours stimulus_;
};

TEST_F(HeadsetMirrorGl, APageStandsWhereTheLeftEyeSeesIt) {
  start();
  open(false);
  show_page();
  EXPECT_EQ(comes_to(yellow, 0.5, 0.5), yellow);
  // The mirror shows 60 degrees of the left eye, and the page is 20 degrees wide at 2 m. Half the page takes
  // 0.5 tan 10 / tan 30 of the mirror's width. The left eye is 0.0315 m left of the head, so the page lies
  // 0.5 (0.0315 / 2) / tan 30 right of the mirror's middle.
  const double half = 0.5 * 0.17633 / 0.57735, shift = 0.5 * 0.0315 / 2 / 0.57735;
  for (const double side_of : {-1.0, 1.0}) {
    EXPECT_EQ(pixel(0.5 + shift + side_of * (half - 0.006), 0.5), yellow) << side_of;
    EXPECT_EQ(pixel(0.5 + shift + side_of * (half + 0.006), 0.5), black) << side_of;
    EXPECT_EQ(pixel(0.5, 0.5 + side_of * (half - 0.006)), yellow) << side_of;
    EXPECT_EQ(pixel(0.5, 0.5 + side_of * (half + 0.006)), black) << side_of;
  }
  close();
}

TEST_F(HeadsetMirrorGl, AStimulusIsBlackUnlessItIsRevealed) {
  start();
  open(false);
  show_page();
  ASSERT_EQ(comes_to(yellow, 0.5, 0.5), yellow);
  display_->hide_page();
  for (int i = 0; i < 12; ++i) show_stimulus();
  EXPECT_EQ(pixel(0.5, 0.5), black);
  EXPECT_EQ(pixel(0.05, 0.05), black);
  mirror_.reset();
  open(true);
  show_stimulus();
  EXPECT_EQ(comes_to(red, 0.5, 0.5), red);
  EXPECT_EQ(pixel(0.02, 0.5), red);
  EXPECT_EQ(pixel(0.98, 0.5), red);
  display_->clear();
  EXPECT_EQ(comes_to(black, 0.5, 0.5), black);
  close();
}

TEST_F(HeadsetMirrorGl, AnImageThatIsHeldStaysInTheWorldWhileTheHeadTurns) {
  start("fov=-15,15,15,-15;at=120:yaw/20");
  open(true);
  while (display_->facts().last.index < 105) display_->turn();
  show_stimulus();
  EXPECT_EQ(comes_to(red, 0.5, 0.5), red);
  EXPECT_EQ(pixel(0.815, 0.5), black);  // outside the picture's 30 degrees
  // After a turn of the head by 20 degrees to the left, the picture's middle is 0.5 tan 20 / tan 30 = 0.315
  // of the mirror's width further right.
  EXPECT_EQ(comes_to(red, 0.815, 0.5), red);
  EXPECT_EQ(pixel(0.5, 0.5), black);
  close();
}

TEST_F(HeadsetMirrorGl, SlotsAreMetWithTheMirrorAsWithout) {
  const auto starved = [&](bool mirrored) {
    const int frames = count("frame "), before = count("starved");  // the log continues from earlier starts
    start("hash=1");
    if (mirrored) open(true);
    study::HeadsetClock clock(*display_);
    study::play_trial(std::vector<std::int64_t>(30, 100'000'000), {}, stimulus_, *display_, clock,
                      {.late_after_ns = 500'000, .overrun_ns = 5'000'000'000}, {});
    display_->clear();
    close();
    EXPECT_GT(count("frame ") - frames, 60);
    return count("starved") - before;
  };
  const int without = starved(false);
  EXPECT_LE(starved(true), without + 1);
}

TEST_F(HeadsetMirrorGl, WhoClosesItLooksOnNoMore) {
  start();
  open(false);
  show_page();
  ASSERT_EQ(comes_to(yellow, 0.5, 0.5), yellow);
  ::Display* const display = screen_.binding().xDisplay;
  ::Window root = 0, parent = 0, *children = nullptr;
  unsigned number = 0;
  ASSERT_NE(XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &number), 0);
  ASSERT_GT(number, 0u);
  XEvent closing{};
  closing.xclient.type = ClientMessage;
  closing.xclient.window = children[number - 1];
  closing.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
  closing.xclient.format = 32;
  closing.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
  XSendEvent(display, children[number - 1], False, NoEventMask, &closing);
  XFree(children);
  XFlush(display);
  EXPECT_EQ(comes_to(black, 0.5, 0.5), black);
  for (int i = 0; i < 5; ++i) display_->turn();
  close();
}

TEST_F(HeadsetMirrorGl, WithoutAScreenThereIsOneClearError) {
  start();
  ::setenv("DISPLAY", ":9999", 1);
  try {
    open(false);
    FAIL() << "it opened";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("window: no display"));
    EXPECT_THAT(error.what(), HasSubstr("--mirror"));
  }
  for (int i = 0; i < 5; ++i) display_->turn();
  close();
}

TEST(GlfwWindowGl, AMonitorThatIsNotThereIsAnErrorThatNamesTheOption) {
  const simulated::XScreen screen;
  ::setenv("DISPLAY", screen.name().c_str(), 1);
  study::WindowChoice choice;
  choice.monitor = 9;
  EXPECT_THAT(
      [&] { study::GlfwWindow window(choice); },
      ::testing::ThrowsMessage<base::Error>(::testing::AllOf(
          HasSubstr("there is no monitor 9"), HasSubstr("connect it, or begin a run with --monitor 0"))));
  ::unsetenv("DISPLAY");
}

/// Runs vip-study run itself, answered by the scripted ray.
class HeadsetMirrorE2e : public test::HeadsetRuns {
 protected:
  test::Ended session(const std::vector<std::string>& more, const std::string& profile = "") {
    base::write_file_atomically(folder_ / "pilot.toml", test::short_protocol_at("[10]"));
    std::vector<std::string> all{"run",
                                 folder_ / "pilot.toml",
                                 "--db",
                                 database_,
                                 "--participant",
                                 "P01",
                                 "--display",
                                 "openxr",
                                 "--clock",
                                 "virtual",
                                 "--trial-seconds",
                                 "0.5",
                                 "--stimulus",
                                 folder_ / "dam.bake"};
    all.insert(all.end(), more.begin(), more.end());
    Environment environment = simulated(
        "size=32x32;point=page;hold=0.4;targets=0.5:0.503,0.5:0.39,0.5:0.9;at=4000:exit;" + profile);
    environment.emplace_back("DISPLAY", screen_.name());
    return run(all, environment);
  }
  std::string events() const {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .text("SELECT group_concat(kind) FROM event WHERE kind IN ('mirror opened', 'pages mirrored')");
  }

  const simulated::XScreen screen_{"800x800"};
  std::string database_ = folder_ / "study.db";
};

TEST_F(HeadsetMirrorE2e, ASessionIsMirroredOnBothBindingsAndRevealingIsLogged) {
  bake_dam(folder_ / "dam.bake", 30);
  const auto ended = session({"--mirror"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("1 of 1 trials answered"));
  EXPECT_EQ(events(), "pages mirrored");
  EXPECT_THAT(calls(), Not(HasSubstr("BREACH")));
  database_ = folder_ / "revealed.db";
  const auto revealed = session({"--mirror", "--mirror-reveal"}, "without=XR_MNDX_egl_enable");
  ASSERT_EQ(revealed.exit_code, 0) << revealed.err;
  EXPECT_EQ(events(), "mirror opened");
  EXPECT_THAT(calls(), Not(HasSubstr("BREACH")));
  EXPECT_EQ(session({"--mirror-reveal"}).exit_code, 2);
}

}  // namespace
}  // namespace apps
