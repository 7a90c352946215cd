#pragma once
/// Sizes of pictures and windows on command lines, the same in all programs.

#include <string>

namespace base {

struct PictureSize {
  int width = 0, height = 0;  ///< px
};

inline constexpr int least_picture_side = 16, most_picture_side = 8192;
/// The size as text: "1280x720".
std::string size_words(PictureSize size);

/// Largest number of pixels of a picture, 8192 x 4096. Drawing the fluid takes about 40 bytes of memory for
/// each pixel.
inline constexpr long long most_picture_pixels = 1LL << 25;

/// Parses "1280x720", without spaces. base::Error, beginning with the option and the text, if the text is not
/// a size, a side is out of range, or the picture has more than most_picture_pixels; the message then says
/// how much memory it would take.
PictureSize parse_picture_size(const std::string& text, const std::string& option = "--size");

}  // namespace base
