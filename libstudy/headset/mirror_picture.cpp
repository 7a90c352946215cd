#include "libstudy/headset/mirror_picture.hpp"

#include <epoxy/gl.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

namespace study {

namespace {

constexpr int strip_px = 12;
constexpr std::chrono::microseconds between_strips{200};

void set_axes(int location, const HeadsetPose& pose) {
  glUniformMatrix3fv(location, 1, GL_FALSE, axes_of(pose).data());
}

}  // namespace

MirrorPicture::MirrorPicture()
    : program_({{GL_VERTEX_SHADER, "screen.vert"}, {GL_FRAGMENT_SHADER, "headset_mirror.frag"}}),
      drawn_(side_px, side_px) {
  glCreateVertexArrays(1, &vertices_);
  program_.use();
  glUniform2f(program_.uniform("size"), side_px, side_px);
  glUniform1i(program_.uniform("samples"), sim::gl_is_software() ? 1 : 4);
  glUniform1f(program_.uniform("slope"), static_cast<float>(std::tan(field_deg * std::numbers::pi / 360)));
}

MirrorPicture::~MirrorPicture() { glDeleteVertexArrays(1, &vertices_); }

bool MirrorPicture::draw(const SeenNow& seen, bool with_picture) const {
  const HeadsetLayers& shown = seen.layers;
  const HeadsetEye &eye = seen.eyes[0], &from = shown.views[0];
  const bool sees = eye.pose.valid();
  const bool picture = sees && with_picture && shown.picture, page = sees && shown.page;
  if (!picture && !page) return false;
  program_.use();
  glUniform3fv(program_.uniform("eye"), 1, eye.pose.place_m.data());
  set_axes(program_.uniform("turn"), eye.pose);
  glUniform1i(program_.uniform("shows_picture"), picture);
  glUniform1i(program_.uniform("shows_page"), page);
  if (picture) {
    // A picture that moves with the head has the eye's current orientation.
    set_axes(program_.uniform("picture_turn"), shown.in_head ? eye.pose : from.pose);
    glUniform4f(program_.uniform("picture_tangents"), std::tan(from.fov.left), std::tan(from.fov.right),
                std::tan(from.fov.down), std::tan(from.fov.up));
    glUniform1f(program_.uniform("picture_share"),
                static_cast<float>(from.width_px) / static_cast<float>(shown.picture->width()));
    glUniform1f(program_.uniform("light"), shown.light);
    glBindTextureUnit(0, shown.picture->texture());
  }
  if (page) {
    glUniform3fv(program_.uniform("page_middle"), 1, shown.place.pose.place_m.data());
    set_axes(program_.uniform("page_turn"), shown.place.pose);
    glUniform2f(program_.uniform("page_size"), shown.place.width_m, shown.place.height_m);
    glBindTextureUnit(1, shown.page->texture());
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, drawn_.framebuffer());
  glViewport(0, 0, side_px, side_px);
  glBindVertexArray(vertices_);
  draw_in_strips();
  return true;
}

/// Draws the picture in strips, with a pause after each. A GPU draws for one context at a time, and software
/// OpenGL is slow, so the headset's slots would wait for a whole picture. With strips they wait for one strip
/// at most.
void MirrorPicture::draw_in_strips() {
  glEnable(GL_SCISSOR_TEST);
  for (int y = 0; y < side_px; y += strip_px) {
    glScissor(0, y, side_px, strip_px);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glFinish();
    std::this_thread::sleep_for(between_strips);
  }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace study
