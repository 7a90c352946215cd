#pragma once
/// Compares two texts line by line.

#include <string>
#include <string_view>
#include <vector>

namespace study::report {

struct LineDifference {
  std::vector<std::string> only_first, only_second;  ///< lines in the order of the text, without blank lines
};

/// Lines outside the longest common subsequence of the two texts' lines. Time and memory grow with the
/// product of their numbers of lines, so texts should have at most a few thousand.
LineDifference line_difference(std::string_view first, std::string_view second);

}  // namespace study::report
