#pragma once
/// What the window itself says to participants, in the protocol's language.

#include <string>

namespace apps {

struct DeskWords {
  std::string go_on, confirm, rest, pause, ready;
  std::string one_open, many_open;  ///< "%d" stands for how many
  std::string wait;                 ///< "%d" stands for seconds
  std::string range;                ///< two "%d"
  std::string optional;
  std::string digits, arrows, tab;  ///< how to answer
  std::string stop_title, stop_text, stop_question, stop_no, stop_yes;
};

/// English where the language ("en", "de", "de-AT", ...) is not known.
const DeskWords& desk_words(const std::string& language);

}  // namespace apps
