#include "libstudy/headset/test_scene.hpp"

#include <epoxy/gl.h>

#include <cmath>

namespace study {

namespace {

TestDisc disc_at(float distance_m, float to_the_right_deg, const std::array<float, 3>& paint) {
  constexpr float degree = 0.017453292f, above = 6 * degree, half_width = 2 * degree;
  return {{distance_m * std::tan(to_the_right_deg * degree), distance_m * std::tan(above), -distance_m},
          distance_m * std::tan(half_width),
          paint};
}

}  // namespace

const std::array<TestDisc, 3>& test_discs() {
  static const std::array<TestDisc, 3> discs{disc_at(0.5f, -12, {1, 0, 0}), disc_at(1, 0, {0, 1, 0}),
                                             disc_at(2, 12, {0, 0, 1})};
  return discs;
}

TestScene::TestScene()
    : program_({{GL_VERTEX_SHADER, "screen.vert"}, {GL_FRAGMENT_SHADER, "headset_scene.frag"}}) {
  glCreateVertexArrays(1, &vertices_);
  program_.use();
  const TestRamp ramp;
  glUniform4f(program_.uniform("ramp"), ramp.left_m, ramp.right_m, ramp.down_m, ramp.up_m);
  glUniform1f(program_.uniform("ramp_z"), ramp.z_m);
  for (int i = 0; i < 3; ++i) {
    const auto& [middle, radius, paint] = test_discs()[static_cast<std::size_t>(i)];
    glUniform4f(program_.uniform("discs[0]") + i, middle[0], middle[1], middle[2], radius);
    glUniform3fv(program_.uniform("paints[0]") + i, 1, paint.data());
  }
}

TestScene::~TestScene() { glDeleteVertexArrays(1, &vertices_); }

void TestScene::draw(const HeadsetEye& eye, unsigned framebuffer, int x_px) const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glViewport(x_px, 0, eye.width_px, eye.height_px);
  for (const GLenum off : {GL_FRAMEBUFFER_SRGB, GL_BLEND, GL_DEPTH_TEST, GL_SCISSOR_TEST}) glDisable(off);
  program_.use();
  const auto turn = axes_of(eye.pose);
  glUniform3fv(program_.uniform("eye"), 1, eye.pose.place_m.data());
  glUniformMatrix3fv(program_.uniform("turn"), 1, GL_FALSE, turn.data());
  glUniform4f(program_.uniform("tangents"), std::tan(eye.fov.left), std::tan(eye.fov.right),
              std::tan(eye.fov.down), std::tan(eye.fov.up));
  glUniform1f(program_.uniform("x"), static_cast<float>(x_px));
  glUniform2f(program_.uniform("size"), static_cast<float>(eye.width_px), static_cast<float>(eye.height_px));
  glBindVertexArray(vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace study
