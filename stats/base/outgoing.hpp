#pragma once
/// Checks of untrusted text that leaves the program as a file name or on a terminal.

#include <string>
#include <string_view>

namespace base {

/// base::Error unless `name` is a relative path of portable characters that stays inside its folder: names
/// separated by '/', each at most 200 letters, digits, '.', '_' and '-', and none beginning with '.' or '-'.
/// `place` is the folder to which the file would be written; the error names it.
void check_file_name(const std::string& name, const std::string& place);

/// Filters a stream of text for a terminal: control characters other than tab and line feed, and bytes that
/// are not UTF-8, become '?'. So text from a file cannot move the cursor or clear the screen.
class TerminalText {
 public:
  /// Returns the next part, filtered. If the part ends within a character, the bytes of that character are
  /// stored and filtered with the part after it.
  std::string next(std::string_view part);
  /// Call at the end of the stream: returns '?' if bytes of an incomplete character are still stored, else an
  /// empty text.
  std::string rest();

 private:
  std::string waiting_;
};

}  // namespace base
