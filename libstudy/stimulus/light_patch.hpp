#pragma once
/// A small square in a corner of the picture that changes its brightness with every frame of a stimulus, for
/// a light sensor.

#include <string>

#include "libstudy/display/stimulus.hpp"

namespace study {

/// A square on a canvas; the origin is its lower left corner.
struct PatchSquare {
  int x_px = 0, y_px = 0, side_px = 0;
};

/// The side on a screen is a sixteenth of the picture's height, and 16 px at least.
inline constexpr int patch_share = 16, least_patch_px = 16;
/// The side in a headset, degrees. The square begins a sixth of the eye's picture from its left and lower
/// edge, in angle, because lenses hide the very corners.
inline constexpr double eye_patch_deg = 4, eye_patch_inset = 1.0 / 6;
/// A quarter of the area of any field of 10 degrees may flash at most (ISO 9241-391, WCAG 2.3.1); a square of
/// this side has it. Degrees.
inline constexpr double largest_patch_deg = 4.4;

/// The square in the lower left corner of a screen's picture.
PatchSquare patch_on(int width_px, int height_px);
/// The square in the lower left part of an eye's picture, on the canvas of both eyes.
PatchSquare patch_on(const EyeView& eye);

/// The side on a screen in words: "22 px, 1.4 degrees". width_mm, distance_mm: the picture's width and the
/// viewing distance; 0: not known. base::Error if the square is larger than largest_patch_deg.
std::string describe_patch(int width_px, int height_px, double width_mm, double distance_mm);

/// Draws the patch over another stimulus: white in the first frame of a showing, black in the second, and so
/// on. All frames show `inner` otherwise unchanged. What draws nothing between stimuli leaves the patch
/// black.
class LightPatch final : public Stimulus {
 public:
  explicit LightPatch(Stimulus& inner) : inner_(inner) {}
  /// The next frame is the first of a showing. start() also rewinds content within a showing, so that it does
  /// not begin a showing.
  void begin_showing() { bright_ = false; }

  std::string description() const override { return inner_.description(); }
  std::int64_t length() const override { return inner_.length(); }
  void start(std::int64_t start_step) override { inner_.start(start_step); }
  FrameFacts prepare(std::int64_t step) override;
  void draw(const Canvas& canvas) override;

 private:
  Stimulus& inner_;
  bool bright_ = false;
};

}  // namespace study
