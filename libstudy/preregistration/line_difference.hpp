#pragma once
/// Line-by-line difference of two texts.

#include <string>
#include <string_view>
#include <vector>

namespace study::report {

struct LineDifference {
  std::vector<std::string> only_first, only_second;  ///< in their order; blank lines are ignored
};

/// By the longest common subsequence of lines; for texts of up to a few thousand lines.
LineDifference line_difference(std::string_view first, std::string_view second);

}  // namespace study::report
