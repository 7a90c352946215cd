/// Pictures of vip-study headset --show for each eye, in the simulated runtime's images.
#include <cmath>
#include <set>

#include "libstudy/headset/test_scene.hpp"
#include "tests/apps/headset_runs.hpp"

namespace apps {
namespace {

using ::testing::HasSubstr;

constexpr double degree = 3.14159265358979 / 180;
constexpr double half_ipd_m = 0.0315;

/// Tangents of the simulated headset's field of view, and the eye's place.
struct Eye {
  const char* name;
  double left, right, x_m;
  double up = std::tan(46 * degree), down = std::tan(-50 * degree);
};
const Eye left_eye{"left", std::tan(-52 * degree), std::tan(42 * degree), -half_ipd_m};
const Eye right_eye{"right", std::tan(-42 * degree), std::tan(52 * degree), half_ipd_m};

/// Slopes of the rays through pixels: right and up from the eye's own axis.
struct Slopes {
  const Eye& eye;
  const sim::Image& image;
  double right(double x) const { return eye.left + (x + 0.5) / image.width * (eye.right - eye.left); }
  double up(double y) const { return eye.up + (y + 0.5) / image.height * (eye.down - eye.up); }
};

using Colour = std::array<int, 3>;
Colour colour_at(const sim::Image& image, int x, int y) {
  const auto* at = &image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                    static_cast<std::size_t>(x))];
  return {at[0], at[1], at[2]};
}

/// Mean position of all pixels of a colour, as slopes; NaN if there are none.
std::array<double, 2> middle_of(const sim::Image& image, const Eye& eye, const Colour& colour) {
  const Slopes slopes{eye, image};
  double right = 0, up = 0, count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (colour_at(image, x, y) != colour) continue;
      right += slopes.right(x);
      up += slopes.up(y);
      ++count;
    }
  }
  return {right / count, up / count};
}

/// Slopes of two points of the yellow horizon: in the picture's leftmost and rightmost columns.
struct Horizon {
  double left_up, right_up, left_right, right_right;
};
Horizon horizon_of(const sim::Image& image, const Eye& eye) {
  const auto mean_up = [&](int x) {
    double up = 0, count = 0;
    for (int y = 0; y < image.height; ++y) {
      if (colour_at(image, x, y) != Colour{255, 255, 0}) continue;
      up += Slopes{eye, image}.up(y);
      ++count;
    }
    return up / count;
  };
  const int last = image.width - 1;
  return {mean_up(0), mean_up(last), Slopes{eye, image}.right(0), Slopes{eye, image}.right(last)};
}

class HeadsetPicturesE2e : public test::HeadsetRuns {
 protected:
  /// The picture of frame 5, when the head is where the profile puts it.
  sim::Image show(const std::string& profile, const Eye& eye) {
    const auto ended = on(profile + ";dump=5", {"--show", "0.2"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    return picture(5, eye.name);
  }
  /// Compares each pixel of the ramp's middle row with its level.
  void expect_ramp(const std::string& profile) {
    const sim::Image image = show("size=800x400;" + profile, left_eye);
    const Slopes slopes{left_eye, image};
    const study::TestRamp ramp;
    const double middle_up =
        0.5 * static_cast<double>(ramp.down_m + ramp.up_m) / -static_cast<double>(ramp.z_m);
    const int y = static_cast<int>((left_eye.up - middle_up) / (left_eye.up - left_eye.down) * image.height);
    std::set<int> levels;
    for (int x = 0; x < image.width; ++x) {
      const double at_m = left_eye.x_m - static_cast<double>(ramp.z_m) * slopes.right(x);
      const double along =
          (at_m - static_cast<double>(ramp.left_m)) / static_cast<double>(ramp.right_m - ramp.left_m);
      if (along < 0.001 || along > 0.999) continue;
      const Colour colour = colour_at(image, x, y);
      EXPECT_EQ(colour[0], colour[1]) << profile;
      EXPECT_EQ(colour[0], colour[2]) << profile;
      EXPECT_NEAR(colour[0], std::floor(256 * along), 1) << profile << " at column " << x;
      levels.insert(colour[0]);
    }
    EXPECT_GE(levels.size(), 254u) << profile;
    EXPECT_LE(*levels.begin(), 1) << profile;
    EXPECT_GE(*levels.rbegin(), 254) << profile;
  }
};

TEST_F(HeadsetPicturesE2e, EachTargetStandsWhereGeometryHasIt) {
  std::array<std::array<double, 3>, 2> right{};
  const std::array<const Eye*, 2> eyes{&left_eye, &right_eye};
  const double step_m = 0.05;
  for (std::size_t e = 0; e < 2; ++e) {
    const Eye& eye = *eyes[e];
    // The head is at the world's origin, and then moved to its right.
    for (const double moved_m : {0.0, step_m}) {
      const sim::Image image = show("size=600x600;at=2:x/" + std::to_string(moved_m), eye);
      for (std::size_t i = 0; i < 3; ++i) {
        const study::TestDisc& disc = study::test_discs()[i];
        Colour paint;
        for (std::size_t c = 0; c < 3; ++c) paint[c] = static_cast<int>(255 * disc.paint[c]);
        const auto [x_m, y_m, z_m] = disc.middle_m;
        const auto found = middle_of(image, eye, paint);
        const double away_m = -static_cast<double>(z_m);
        // 0.0007 is a fifth of a pixel, as a slope.
        EXPECT_NEAR(found[0], (static_cast<double>(x_m) - eye.x_m - moved_m) / away_m, 0.0007)
            << eye.name << i;
        EXPECT_NEAR(found[1], static_cast<double>(y_m) / away_m, 0.0007) << eye.name << i;
        if (moved_m == 0) right[e][i] = found[0];
      }
    }
  }
  // Nearer discs must have a larger parallax between the eyes, with the right sign.
  const double parallax[] = {right[0][0] - right[1][0], right[0][1] - right[1][1], right[0][2] - right[1][2]};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(parallax[i], 2 * half_ipd_m / -static_cast<double>(study::test_discs()[i].middle_m[2]),
                0.0014);
}

TEST_F(HeadsetPicturesE2e, TheHorizonIsLevelAndTiltsAgainstTheHead) {
  for (const Eye& eye : {left_eye, right_eye}) {
    const Horizon level = horizon_of(show("size=600x600", eye), eye);
    EXPECT_NEAR(level.left_up, 0, 0.003);
    EXPECT_NEAR(level.right_up, 0, 0.003);
    // If the head leans 10 degrees to the left, the line falls by 10 degrees to the right in its picture.
    const Horizon tilted = horizon_of(show("size=600x600;at=2:roll/10", eye), eye);
    const double slope = (tilted.right_up - tilted.left_up) / (tilted.right_right - tilted.left_right);
    EXPECT_NEAR(slope, -std::tan(10 * degree), 0.004);
  }
}

TEST_F(HeadsetPicturesE2e, EveryGreyArrivesInSrgbAndInLinearImages) {
  expect_ramp("formats=srgb_only");
  expect_ramp("formats=linear_first");
  expect_ramp("formats=rgba16f,rgba8");
  expect_ramp("formats=linear_first;broken=srgb8_alpha8");
  // A call into the runtime may change any GL state.
  expect_ramp("leave_context=other;leave_error=1");
  expect_ramp("leave_context=none");
}

}  // namespace
}  // namespace apps
