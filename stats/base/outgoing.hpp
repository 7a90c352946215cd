#pragma once
/// Texts that others wrote, where they leave the program: as the name of a file, or for a terminal.

#include <string>
#include <string_view>

namespace base {

/// base::Error unless `name` is made of names of files, with '/' between them, that every computer takes and
/// that lead nowhere else: each at most 200 letters, digits, '.', '_' and '-', and none begins with '.' or
/// '-'. place: the folder that they would be written to.
void check_file_name(const std::string& name, const std::string& place);

/// A stream of text for a terminal, in which what is no text is '?': control characters but the tab and the
/// line end, and bytes that are not UTF-8. So a name in a file moves no cursor and clears no screen.
class TerminalText {
 public:
  /// The next part; a character that is cut at its end waits for the part after it.
  std::string next(std::string_view part);
  /// What waits, at the end of the stream.
  std::string rest();

 private:
  std::string waiting_;
};

}  // namespace base
