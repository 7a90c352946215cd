#pragma once
/// With what a person in a headset may answer.

#include <string>

namespace apps {

struct AnswerWays {
  bool ray = false;       ///< a hand points, select chooses
  bool stick = false;     ///< a thumbstick goes from choice to choice, select takes it
  bool dwell = false;     ///< one looks at a choice for a while
  bool keyboard = false;  ///< the terminal's that started the program
};

/// All but dwell.
extern const char* const usual_answer_ways;

/// Of words with commas between, such as "ray,stick". base::Error for others, for none, and for ray and dwell
/// together: both point.
AnswerWays parse_answer_ways(const std::string& words);

/// base::Error when a person could answer with nothing but keys that the console takes. `words` may be empty:
/// as usual.
void check_keys_are_free(const std::string& words, bool console);

}  // namespace apps
