#pragma once
/// The ways in which a person in a headset may answer.

#include <string>

namespace study {

struct AnswerWays {
  bool ray = false;       ///< pointing with a controller; the select button chooses
  bool stick = false;     ///< a thumbstick moves between choices; select chooses
  bool dwell = false;     ///< looking at a choice for a while chooses it
  bool keyboard = false;  ///< keys of the terminal that started the program
};

/// The ways to answer without the option --answer: all but dwell.
extern const char* const usual_answer_ways;

/// Parses comma-separated words such as "ray,stick". base::Error for unknown words, for no word, and for ray
/// together with dwell, because both move the pointer.
AnswerWays parse_answer_ways(const std::string& words);

/// base::Error if the keyboard is the only way to answer and the experimenter's console uses the keyboard.
/// words: as for parse_answer_ways(); if empty, usual_answer_ways.
void check_keys_are_free(const std::string& words, bool console);

}  // namespace study
