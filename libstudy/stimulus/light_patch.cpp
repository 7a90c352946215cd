#include "libstudy/stimulus/light_patch.hpp"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr double degree = std::numbers::pi / 180;

void fill_square(unsigned framebuffer, const PatchSquare& square, bool bright) {
  const float level = bright ? 1 : 0;
  const float colour[4] = {level, level, level, 1};
  glScissor(square.x_px, square.y_px, square.side_px, square.side_px);
  glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, colour);
}

}  // namespace

PatchSquare patch_on(int width_px, int height_px) {
  return {0, 0, std::min({std::max(height_px / patch_share, least_patch_px), width_px, height_px})};
}

PatchSquare patch_on(const EyeView& eye) {
  const double from_x = eye.left_rad + eye_patch_inset * (eye.right_rad - eye.left_rad);
  const double from_y = eye.down_rad + eye_patch_inset * (eye.up_rad - eye.down_rad);
  const double across = std::tan(eye.right_rad) - std::tan(eye.left_rad);
  const double along = std::tan(eye.up_rad) - std::tan(eye.down_rad);
  const auto x_of = [&](double angle) {
    return static_cast<int>(std::lround(eye.width_px * (std::tan(angle) - std::tan(eye.left_rad)) / across));
  };
  const int y_px =
      static_cast<int>(std::lround(eye.height_px * (std::tan(from_y) - std::tan(eye.down_rad)) / along));
  const int x_px = x_of(from_x), end_px = x_of(from_x + eye_patch_deg * degree);
  const int room = std::min(eye.width_px - x_px, eye.height_px - y_px);
  return {eye.x_px + x_px, eye.y_px + y_px, std::clamp(end_px - x_px, 1, std::max(1, room))};
}

std::string describe_patch(int width_px, int height_px, double width_mm, double distance_mm) {
  const int side_px = patch_on(width_px, height_px).side_px;
  std::string text = fmt::format("{} px", side_px);
  if (!(width_mm > 0 && distance_mm > 0)) return text + ", of an unknown angle";
  const double angle_deg = 2 * std::atan(0.5 * side_px * width_mm / width_px / distance_mm) / degree;
  text += fmt::format(", {:.1f} degrees", angle_deg);
  if (angle_deg > largest_patch_deg)
    throw base::Error("--light-patch",
                      fmt::format("would be a flashing square of {}, and more than {} degrees are not safe",
                                  text, largest_patch_deg),
                      "choose a greater viewing distance or a smaller picture");
  return text;
}

FrameFacts LightPatch::prepare(std::int64_t step) {
  bright_ = !bright_;
  return inner_.prepare(step);
}

void LightPatch::draw(const Canvas& canvas) {
  inner_.draw(canvas);
  glEnable(GL_SCISSOR_TEST);
  if (canvas.eyes.empty())
    fill_square(canvas.framebuffer, patch_on(canvas.width_px, canvas.height_px), bright_);
  for (const EyeView& eye : canvas.eyes) fill_square(canvas.framebuffer, patch_on(eye), bright_);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace study
