#pragma once
/// Our pictures, which hold sRGB values, into images of whatever format a runtime offers.

#include <cstdint>
#include <string>
#include <vector>

#include "libsim/render/gl_program.hpp"
#include "libsim/render/offscreen.hpp"

namespace apps {

/// The formats of a list that can take a picture, the best first: 8-bit sRGB, then linear ones fine enough
/// for all 256 levels, then the others. Depths are left out.
std::vector<std::int64_t> picture_formats(const std::vector<std::int64_t>& offered);
/// Each of the 256 levels of an sRGB picture arrives within one.
bool keeps_levels(std::int64_t format);
/// "GL_SRGB8_ALPHA8" or the number in hex.
std::string gl_format_name(std::int64_t format);

/// What of a picture is copied, and how bright.
struct PicturePart {
  int x_px = 0;     ///< where it begins, from the left
  float light = 1;  ///< its levels are multiplied by it, [0, 1]
};
struct CopyTarget {
  unsigned texture = 0;
  unsigned framebuffer = 0;  ///< that has the texture as its colour
  int width_px = 0, height_px = 0;
};

/// Copies pictures into textures of one format. Needs a current context always.
class PictureCopy {
 public:
  explicit PictureCopy(std::int64_t format);
  ~PictureCopy();
  PictureCopy(const PictureCopy&) = delete;
  PictureCopy& operator=(const PictureCopy&) = delete;
  /// As many pixels as the target has. Values arrive as they are when the image is shown as what its format
  /// says.
  void copy(const sim::Offscreen& picture, const PicturePart& part, const CopyTarget& to) const;

 private:
  bool same_words_;  ///< the format keeps the pictures' own words, so that nothing need be drawn
  sim::GlProgram program_;
  unsigned vertices_ = 0;
};

}  // namespace apps
