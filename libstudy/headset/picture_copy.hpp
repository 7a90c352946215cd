#pragma once
/// Copies pictures with sRGB values into images of any format that a runtime offers.

#include <cstdint>
#include <string>
#include <vector>

#include "libsim/gl/gl_program.hpp"
#include "libsim/gl/offscreen.hpp"

namespace study {

/// The offered formats that can store a picture, best first: 8-bit sRGB, then linear formats fine
/// enough for all 256 levels, then coarser ones. Excludes depth formats and unknown formats.
std::vector<std::int64_t> picture_formats(const std::vector<std::int64_t>& offered);
/// True if images of this format show each of the 256 sRGB levels with an error of at most one level.
bool keeps_levels(std::int64_t format);
/// The name of a pixel format, such as "GL_SRGB8_ALPHA8", or its number in hexadecimal.
std::string gl_format_name(std::int64_t format);

/// The part of a picture to copy, and its brightness.
struct PicturePart {
  int x_px = 0;     ///< left edge of the part
  float light = 1;  ///< factor on the sRGB levels, [0, 1]
  bool operator==(const PicturePart&) const = default;
};
struct CopyTarget {
  unsigned texture = 0;
  unsigned framebuffer = 0;  ///< has the texture as its colour attachment
  int width_px = 0, height_px = 0;
};

/// Copies pictures into textures of one format. An OpenGL context must be current at every call.
class PictureCopy {
 public:
  explicit PictureCopy(std::int64_t format);
  ~PictureCopy();
  PictureCopy(const PictureCopy&) = delete;
  PictureCopy& operator=(const PictureCopy&) = delete;
  /// Copies the part of the picture that has the target's size. A runtime that decodes the texture by its
  /// format shows the picture's sRGB levels times part.light.
  void copy(const sim::Offscreen& picture, const PicturePart& part, const CopyTarget& to) const;

 private:
  bool same_words_;  ///< the format is that of the pictures: a copy with light = 1 needs no shader
  sim::GlProgram program_;
  unsigned vertices_ = 0;
};

}  // namespace study
