#pragma once
/// What the window itself says to participants, in the protocol's language.

#include <string>

#include "libstudy/session/participant.hpp"

namespace apps {

/// A page without questions.
struct DeskPage {
  std::string title, text, button;
};

/// One of two; the first is the one that does no harm by mistake.
struct DeskChoice {
  std::string title, text, question, first, second;
};

struct DeskWords {
  std::string go_on, confirm, finish, rest, pause, ready;
  std::string first, second;                  ///< of two stimuli
  std::string held_title, held;               ///< while the experimenter pauses
  std::string trouble_title, trouble;         ///< when a trial cannot be shown
  std::string corner, begin;                  ///< how to stop: on every page, and as a sentence on the first
  std::string corner_by_hand, begin_by_hand;  ///< the same in a headset
  std::string by_ray, by_stick, by_dwell;     ///< how to answer there, as sentences
  std::string one_open, many_open;            ///< "{}" stands for how many
  std::string wait;                           ///< "{}" stands for seconds
  std::string range;                          ///< two "{}"
  std::string optional;
  std::string digits, arrows, tab;  ///< how to answer
  DeskChoice stop;
  DeskPage over, refused, not_eligible, kept, deleted, goodbye;
  DeskChoice stay_out, questionnaire, keep;

  const DeskPage& page(study::Notice notice) const;
  const DeskChoice& choice(study::Offer offer) const;
};

/// English where the language ("en", "de", "de-AT", ...) is not known.
const DeskWords& desk_words(const std::string& language);

}  // namespace apps
