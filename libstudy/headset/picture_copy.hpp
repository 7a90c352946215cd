#pragma once
/// Copies pictures with sRGB values into images of any format that a runtime offers.

#include <cstdint>
#include <string>
#include <vector>

#include "libsim/gl/gl_program.hpp"
#include "libsim/gl/offscreen.hpp"

namespace study {

/// The known formats that can take a picture, best first: 8-bit sRGB, then linear ones fine enough for all
/// 256 levels, then coarser ones. Depth and unknown formats are left out.
std::vector<std::int64_t> picture_formats(const std::vector<std::int64_t>& offered);
/// True if each of the 256 levels of an sRGB picture arrives within one level.
bool keeps_levels(std::int64_t format);
/// "GL_SRGB8_ALPHA8", or the number in hex.
std::string gl_format_name(std::int64_t format);

/// The part of a picture to copy, and its brightness.
struct PicturePart {
  int x_px = 0;     ///< left edge of the part
  float light = 1;  ///< factor of its levels, [0, 1]
  bool operator==(const PicturePart&) const = default;
};
struct CopyTarget {
  unsigned texture = 0;
  unsigned framebuffer = 0;  ///< has the texture as its colour attachment
  int width_px = 0, height_px = 0;
};

/// Copies pictures into textures of one format. Needs a current context at every call.
class PictureCopy {
 public:
  explicit PictureCopy(std::int64_t format);
  ~PictureCopy();
  PictureCopy(const PictureCopy&) = delete;
  PictureCopy& operator=(const PictureCopy&) = delete;
  /// Copies as many pixels as the target has. Levels arrive unchanged if the image is shown as its format
  /// says.
  void copy(const sim::Offscreen& picture, const PicturePart& part, const CopyTarget& to) const;

 private:
  bool same_words_;  ///< the format stores pixels as the pictures do, so that copying needs no drawing
  sim::GlProgram program_;
  unsigned vertices_ = 0;
};

}  // namespace study
