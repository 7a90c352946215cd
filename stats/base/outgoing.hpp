#pragma once
/// Checks of untrusted text that leaves the program as a file name or on a terminal.

#include <string>
#include <string_view>

namespace base {

/// base::Error unless `name` is a relative path that is valid on every computer and stays inside its folder:
/// names separated by '/', each at most 200 letters, digits, '.', '_' and '-', and none beginning with '.' or
/// '-'. place: the folder that the file would be written to.
void check_file_name(const std::string& name, const std::string& place);

/// Filters a stream of text for a terminal: control characters other than tab and line feed, and bytes that
/// are not UTF-8, become '?'. So text from a file cannot move the cursor or clear the screen.
class TerminalText {
 public:
  /// Filters the next part. A character that is cut at its end is held back until the part after it.
  std::string next(std::string_view part);
  /// Call at the end of the stream: '?' for a character that was held back, else empty.
  std::string rest();

 private:
  std::string waiting_;
};

}  // namespace base
