#pragma once
/// What two texts differ in, line by line.

#include <string>
#include <string_view>
#include <vector>

namespace apps::report {

struct LineDifference {
  std::vector<std::string> only_first, only_second;  ///< in their order; blank lines are passed over
};

/// By the longest common subsequence of lines. Texts of up to some thousand lines.
LineDifference line_difference(std::string_view first, std::string_view second);

}  // namespace apps::report
