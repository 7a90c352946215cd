/// The patch for a light sensor: its place and size, how it is drawn, and what a run refuses.
#include "libstudy/stimulus/light_patch.hpp"

#include <cmath>

#include "libstudy/display/null.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/runner/run_options.hpp"
#include "libstudy/stimulus/headless_display.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "stats/base/error.hpp"
#include "tests/apps/headset_runs.hpp"

// epoxy comes before other OpenGL headers.
#include <epoxy/gl.h>

namespace apps {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

constexpr double degree = 3.14159265358979 / 180;

/// A stimulus that fills its canvas with grey, and says at which step it was rewound.
class Grey final : public study::Stimulus {
 public:
  std::string description() const override { return "grey"; }
  std::int64_t length() const override { return 3; }
  void start(std::int64_t step) override { starts.push_back(step); }
  study::FrameFacts prepare(std::int64_t) override { return {}; }
  void draw(const study::Canvas& canvas) override {
    const float grey[4] = {0.5f, 0.5f, 0.5f, 1};
    glClearNamedFramebufferfv(canvas.framebuffer, GL_COLOR, 0, grey);
  }
  std::vector<std::int64_t> starts;
};

int red_at(const sim::Image& image, int x, int y) {
  return image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x))];
}

/// The pixels that are neither near grey 128 nor of the other brightness: white (true) or black.
struct Found {
  int left = 1 << 20, top = 1 << 20, right = -1, bottom = -1, count = 0;
};
Found pixels_of(const sim::Image& image, bool white) {
  Found found;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (white ? red_at(image, x, y) < 255 : red_at(image, x, y) > 0) continue;
      found.left = std::min(found.left, x);
      found.right = std::max(found.right, x);
      found.top = std::min(found.top, y);
      found.bottom = std::max(found.bottom, y);
      ++found.count;
    }
  }
  return found;
}

TEST(LightPatchGl, IsWhiteAndBlackInTurnInTheLowerLeftCornerAlone) {
  study::HeadlessDisplay display(320, 320);
  Grey grey;
  study::LightPatch patch(grey);
  study::VirtualClock clock;
  std::vector<bool> white;
  const auto each = [&](const study::FrameRecord&) {
    const sim::Image image = display.read();
    const bool bright = red_at(image, 5, 315) == 255;
    const Found found = pixels_of(image, bright);
    EXPECT_EQ(found.count, 20 * 20) << "a sixteenth of the height";
    EXPECT_EQ(found.left, 0);
    EXPECT_EQ(found.bottom, 319);
    EXPECT_EQ(pixels_of(image, !bright).count, 0) << "the rest of the picture never flashes";
    white.push_back(bright);
  };
  const std::vector<std::int64_t> intervals(5, 20'000'000);
  for (int showing = 0; showing < 2; ++showing) {
    patch.begin_showing();
    study::play_trial(intervals, {}, patch, display, clock, {}, each);
  }
  EXPECT_THAT(white, ElementsAre(true, false, true, false, true, true, false, true, false, true))
      << "also where the content loops within a showing";
  EXPECT_GT(grey.starts.size(), 2u) << "the content loops";
}

TEST(LightPatch, IsSmallAndRefusedWhereItWouldNotBe) {
  EXPECT_EQ(study::patch_on(1920, 1080).side_px, 67);
  EXPECT_EQ(study::patch_on(64, 36).side_px, 16);
  EXPECT_EQ(study::describe_patch(1920, 1080, 0, 0), "67 px, of an unknown angle");
  EXPECT_EQ(study::describe_patch(1920, 1080, 531, 600), "67 px, 1.8 degrees");
  try {
    study::describe_patch(1920, 1080, 1800, 600);
    ADD_FAILURE() << "6 degrees";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("more than 4.4 degrees are not safe"));
  }
  study::EyeView eye;
  eye.left_rad = -52 * degree;
  eye.right_rad = 42 * degree;
  eye.up_rad = 46 * degree;
  eye.down_rad = -50 * degree;
  eye.x_px = 1000;
  eye.width_px = eye.height_px = 1000;
  const study::PatchSquare square = study::patch_on(eye);
  const double across = std::tan(eye.right_rad) - std::tan(eye.left_rad);
  const auto angle = [&](int px) {
    return std::atan(std::tan(eye.left_rad) + (px - 1000) / 1000.0 * across) / degree;
  };
  EXPECT_NEAR(angle(square.x_px), -52 + 94 / 6.0, 0.1);
  EXPECT_NEAR(angle(square.x_px + square.side_px) - angle(square.x_px), 4, 0.1);
  EXPECT_GT(square.y_px, 0);
  EXPECT_LT(square.y_px + square.side_px, 400) << "in the lower part";
}

class LightPatchE2e : public test::HeadsetRuns {
 protected:
  LightPatchE2e() { base::write_file_atomically(protocol_, test::asking_at_60(false)); }
  test::Ended session(const std::vector<std::string>& more, const std::string& dumped = "0") {
    std::vector<std::string> all{"run", protocol_, "--db", database_, "--light-patch"};
    all.insert(all.end(), more.begin(), more.end());
    return study("size=96x96;dump=" + dumped, all);
  }
  const std::string database_ = folder_ / "study.db", protocol_ = folder_ / "asking.toml";
};

// The sequence of brightness in the patch's place, by the images that the runtime got for each eye.
TEST_F(LightPatchE2e, BothEyesOfAHeadsetHaveItAndTheRecordSaysSo) {
  constexpr int first_slot = 20, last_slot = 73;  // the first showing and black around it
  std::string dumped = "0";
  for (int frame = first_slot; frame <= last_slot; ++frame) dumped += "," + std::to_string(frame);
  const std::string dam = folder_ / "dam.bake";
  bake_dam(dam, 60);
  const auto ended = session({"--observer", "constant:1", "--display", "openxr", "--clock", "virtual",
                              "--participants", "1", "--stimulus", dam},
                             dumped);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("light patch: 4 degrees, in the lower left of both eyes' pictures; it "
                                   "flashes, so cover it"));
  study::sqlite::Connection database(database_, study::sqlite::Open::Read);
  for (const std::string eye : {"left", "right"}) {
    SCOPED_TRACE(eye);
    const double left = eye == "left" ? -52 : -42, right = eye == "left" ? 42 : 52;
    study::EyeView view;
    view.left_rad = left * degree;
    view.right_rad = right * degree;
    view.up_rad = 46 * degree;
    view.down_rad = -50 * degree;
    view.width_px = view.height_px = 96;
    const study::PatchSquare square = study::patch_on(view);
    std::vector<std::pair<int, int>> runs;  // level and number of slots
    for (int frame = first_slot; frame <= last_slot; ++frame) {
      const std::string name = "0000" + std::to_string(frame) + "_" + eye + ".png";
      if (!std::filesystem::exists(folder_ / name)) continue;  // black
      const sim::Image image = picture(frame, eye);
      const int level = red_at(image, square.x_px + square.side_px / 2,
                               image.height - 1 - (square.y_px + square.side_px / 2));
      if (runs.empty() || runs.back().first != level) runs.emplace_back(level, 0);
      ++runs.back().second;
    }
    // 10 frames/s at 90 Hz: five frames of nine slots each.
    EXPECT_THAT(runs, ElementsAre(Pair(255, 9), Pair(0, 9), Pair(255, 9), Pair(0, 9), Pair(255, 9)));
  }
  EXPECT_EQ(database.integer("SELECT json_extract(options, '$.light_patch') FROM run"), 1);
  EXPECT_THAT(database.text("SELECT stimulus FROM session"), HasSubstr("with a light patch"));
}

TEST_F(LightPatchE2e, NobodyIsFlashedAndNothingIsPromisedWithoutADisplay) {
  const auto person = session({"--participant", "P01", "--display", "openxr"});
  EXPECT_EQ(person.exit_code, 1);
  EXPECT_THAT(person.err, HasSubstr("would flash at the person"));
  const auto none = session({"--observer", "constant:1", "--display", "none"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("needs a display"));
  const auto near = session({"--observer", "constant:1", "--display", "headless", "--screen-width-mm", "2000",
                             "--viewing-distance-mm", "500"});
  EXPECT_EQ(near.exit_code, 1);
  EXPECT_THAT(near.err, HasSubstr("more than 4.4 degrees"));
  EXPECT_FALSE(std::filesystem::exists(database_));
}

TEST(LightPatch, IsOffByDefaultAndKeptInTheRunsOptions) {
  study::RunOptions options;
  EXPECT_THAT(study::format_run_options(options), Not(HasSubstr("light_patch")));
  options.light_patch = true;
  EXPECT_TRUE(study::parse_run_options(study::format_run_options(options), "study.db").light_patch);
}

}  // namespace
}  // namespace apps
