#pragma once
/// The ways in which a person in a headset may answer.

#include <string>

namespace study {

struct AnswerWays {
  bool ray = false;       ///< a hand controller points, select chooses
  bool stick = false;     ///< a thumbstick moves between choices, select chooses
  bool dwell = false;     ///< looking at a choice for a while chooses it
  bool keyboard = false;  ///< of the terminal that started the program
};

/// All but dwell.
extern const char* const usual_answer_ways;

/// Parses comma-separated words such as "ray,stick". base::Error for unknown words, for none, and for ray
/// with dwell, because both point.
AnswerWays parse_answer_ways(const std::string& words);

/// base::Error if the only way to answer is the keyboard and the console uses it. Empty `words`:
/// usual_answer_ways.
void check_keys_are_free(const std::string& words, bool console);

}  // namespace study
