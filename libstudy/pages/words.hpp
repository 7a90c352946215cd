#pragma once
/// The program's own texts for participants, in the protocol's language.

#include <string>

#include "libstudy/session/participant.hpp"

namespace study {

/// A page without questions.
struct DeskPage {
  std::string title, text, button;
};

/// A choice of two; the first is the harmless one.
struct DeskChoice {
  std::string title, text, question, first, second;
};

struct DeskWords {
  std::string go_on, confirm, finish, rest, pause, ready;
  std::string first, second;                  ///< announce the stimuli of a pair
  std::string held_title, held;               ///< during a pause by the experimenter
  std::string trouble_title, trouble;         ///< if a trial cannot be shown
  std::string corner, begin;                  ///< how to stop: on every page, and as a sentence on the first
  std::string corner_by_hand, begin_by_hand;  ///< the same in a headset
  std::string by_ray, by_stick, by_dwell;     ///< how to answer in a headset, as sentences
  std::string one_open, many_open;            ///< "{}" is the number
  std::string wait;                           ///< "{}" is the seconds
  std::string range;                          ///< two "{}"
  std::string optional;
  std::string digits, arrows, tab;  ///< how to answer
  DeskChoice stop;
  DeskPage over, refused, not_eligible, kept, deleted, goodbye;
  DeskChoice stay_out, questionnaire, keep;

  const DeskPage& page(Notice notice) const;
  const DeskChoice& choice(Offer offer) const;
};

/// English if the language ("en", "de", "de-AT", ...) is not known.
const DeskWords& desk_words(const std::string& language);

}  // namespace study
