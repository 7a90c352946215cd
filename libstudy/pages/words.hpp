#pragma once
/// The texts that the program itself shows to participants, in the protocol's language.

#include <string>

#include "libstudy/session/participant.hpp"

namespace study {

/// Texts of a page without questions.
struct DeskPage {
  std::string title, text, button;
};

/// Texts of a page with a choice of two answers; the second answer ends, deletes or leaves out something.
struct DeskChoice {
  std::string title, text, question, first, second;
};

struct DeskWords {
  std::string go_on, confirm, finish, rest, pause, ready;
  std::string first, second;                  ///< announce the two stimuli of a pair
  std::string held_title, held;               ///< shown while the experimenter pauses the session
  std::string trouble_title, trouble;         ///< shown if a trial cannot be shown
  std::string corner, begin;                  ///< how to stop: a note on pages, a sentence on the first page
  std::string corner_by_hand, begin_by_hand;  ///< as `corner` and `begin`, in a headset
  std::string by_ray, by_stick, by_dwell;     ///< how to answer in a headset, as sentences
  std::string one_open, many_open;            ///< "{}" stands for the number of open questions
  std::string wait;                           ///< "{}" stands for the seconds until confirming is possible
  std::string range;                          ///< two "{}" stand for the lowest and the highest number
  std::string optional;
  std::string digits, arrows, tab, line;  ///< how to answer with the keyboard
  std::string letters;  ///< how to answer yes or no with letter keys; two "{}" stand for the keys
  std::string react, react_by_hand;  ///< how to react to a cue: with any key, and in a headset
  DeskChoice stop;
  DeskPage over, refused, not_eligible, kept, deleted, goodbye;
  DeskChoice stay_out, questionnaire, keep;

  const DeskPage& page(Notice notice) const;
  const DeskChoice& choice(Offer offer) const;
};

/// The texts in a language ("en", "de", "de-AT", ...); in English if there are none in this language.
const DeskWords& desk_words(const std::string& language);

}  // namespace study
