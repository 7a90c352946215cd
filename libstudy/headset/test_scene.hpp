#pragma once
/// A scene for checking that a headset displays correctly.

#include <array>

#include "libsim/gl/gl_program.hpp"
#include "libstudy/headset/views.hpp"

namespace study {

/// A disc in the headset's world that faces +z.
struct TestDisc {
  std::array<float, 3> middle_m;
  float radius_m;
  std::array<float, 3> paint;  ///< sRGB, [0, 1]
};
/// Three discs, each 4 degrees wide: red to the left at 0.5 m, green ahead at 1 m, blue to the right at 2 m.
const std::array<TestDisc, 3>& test_discs();

/// Edges of an upright strip with 256 grey levels, level 0 at the left.
struct TestRamp {
  float left_m = -0.6f, right_m = 0.6f, down_m = -0.6f, up_m = -0.3f, z_m = -1.5f;
};

/// Draws test_discs(), the grey ramp, and a yellow line at infinity at eye level. Needs a current OpenGL
/// context.
class TestScene {
 public:
  TestScene();
  ~TestScene();
  TestScene(const TestScene&) = delete;
  TestScene& operator=(const TestScene&) = delete;
  /// Draws the eye's view, with sRGB values, into the part of a framebuffer that starts at x_px and has the
  /// eye's size.
  void draw(const HeadsetEye& eye, unsigned framebuffer, int x_px) const;

 private:
  sim::GlProgram program_;
  unsigned vertices_ = 0;
};

}  // namespace study
