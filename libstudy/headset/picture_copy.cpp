#include "libstudy/headset/picture_copy.hpp"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace study {

namespace {

enum Worth { none, coarse, fine_linear, srgb };
struct Format {
  const char* name;
  Worth worth;
};

/// Known pixel formats and their quality for pictures. Linear formats with half floats or 16 bits resolve the
/// darkest sRGB levels; linear formats with 8, 10 or 11 bits do not.
const std::map<std::int64_t, Format> known{
    {GL_SRGB8_ALPHA8, {"GL_SRGB8_ALPHA8", srgb}},
    {GL_SRGB8, {"GL_SRGB8", srgb}},
    {GL_RGBA16F, {"GL_RGBA16F", fine_linear}},
    {GL_RGB16F, {"GL_RGB16F", fine_linear}},
    {GL_RGBA16, {"GL_RGBA16", fine_linear}},
    {GL_RGBA32F, {"GL_RGBA32F", fine_linear}},
    {GL_RGB10_A2, {"GL_RGB10_A2", coarse}},
    {GL_R11F_G11F_B10F, {"GL_R11F_G11F_B10F", coarse}},
    {GL_RGBA8, {"GL_RGBA8", coarse}},
    {GL_DEPTH_COMPONENT16, {"GL_DEPTH_COMPONENT16", none}},
    {GL_DEPTH_COMPONENT24, {"GL_DEPTH_COMPONENT24", none}},
    {GL_DEPTH_COMPONENT32F, {"GL_DEPTH_COMPONENT32F", none}},
    {GL_DEPTH24_STENCIL8, {"GL_DEPTH24_STENCIL8", none}},
    {GL_DEPTH32F_STENCIL8, {"GL_DEPTH32F_STENCIL8", none}},
};

Worth worth_of(std::int64_t format) {
  const auto found = known.find(format);
  return found == known.end() ? none : found->second.worth;
}

}  // namespace

std::vector<std::int64_t> picture_formats(const std::vector<std::int64_t>& offered) {
  std::vector<std::int64_t> out;
  for (const std::int64_t format : offered) {
    if (worth_of(format) != none) out.push_back(format);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](std::int64_t a, std::int64_t b) { return worth_of(a) > worth_of(b); });
  return out;
}

bool keeps_levels(std::int64_t format) { return worth_of(format) >= fine_linear; }

std::string gl_format_name(std::int64_t format) {
  const auto found = known.find(format);
  return found == known.end() ? fmt::format("0x{:x}", format) : found->second.name;
}

PictureCopy::PictureCopy(std::int64_t format)
    : same_words_(format == GL_SRGB8_ALPHA8),
      program_({{GL_VERTEX_SHADER, "screen.vert"}, {GL_FRAGMENT_SHADER, "headset_copy.frag"}},
               worth_of(format) == srgb ? "" : "#define TO_LINEAR\n") {
  glCreateVertexArrays(1, &vertices_);
}

PictureCopy::~PictureCopy() { glDeleteVertexArrays(1, &vertices_); }

void PictureCopy::copy(const sim::Offscreen& picture, const PicturePart& part, const CopyTarget& to) const {
  if (same_words_ && part.light == 1) {
    glCopyImageSubData(picture.texture(), GL_TEXTURE_2D, 0, part.x_px, 0, 0, to.texture, GL_TEXTURE_2D, 0, 0,
                       0, 0, to.width_px, to.height_px, 1);
    return;
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to.framebuffer);
  glViewport(0, 0, to.width_px, to.height_px);
  for (const GLenum off : {GL_FRAMEBUFFER_SRGB, GL_BLEND, GL_DEPTH_TEST, GL_SCISSOR_TEST, GL_CULL_FACE})
    glDisable(off);  // GL_FRAMEBUFFER_SRGB would encode the sRGB values a second time
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  program_.use();
  glUniform1i(program_.uniform("x"), part.x_px);
  glUniform1f(program_.uniform("light"), part.light);
  glBindTextureUnit(0, picture.texture());
  glBindSampler(0, 0);
  glBindVertexArray(vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace study
