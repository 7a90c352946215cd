#pragma once
/// Sizes of pictures and windows as command lines give them, alike in all programs.

#include <string>

namespace apps {

struct PictureSize {
  int width = 0, height = 0;  ///< px
};

inline constexpr int least_picture_side = 16, most_picture_side = 8192;
/// "1280x720".
std::string size_words(PictureSize size);

/// 8192x4096. A picture of fluid takes about 40 bytes a pixel while it is drawn.
inline constexpr long long most_picture_pixels = 1LL << 25;

/// "1280x720", with nothing before, between or after. base::Error that begins with the option and the text
/// when that is no size, a side is out of range, or the picture would take too much memory, which is named.
PictureSize parse_picture_size(const std::string& text, const std::string& option = "--size");

}  // namespace apps
