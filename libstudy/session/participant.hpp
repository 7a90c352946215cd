#pragma once
/// Who sits in front of the display: a person at a window, or a simulated one. Both go through the same
/// pages.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/fps_window.hpp"

namespace study {

/// One stimulus as it was shown.
struct ShownStimulus {
  int cell = 0;  ///< index into Design::cells
  Cell what;
  stats::FpsMoments realised;  ///< of the frames as they were shown
  double longest_ms = 0;       ///< longest interval
  double play_speed = 0;       ///< simulated time over time shown
};

/// What a participant is asked about.
struct Occasion {
  std::string participant;
  std::uint64_t seed = 0;
  int position = 0;  ///< of the unit in the session
  BlockKind block = BlockKind::Stimulus;
  std::vector<ShownStimulus> shown;  ///< one, or two of a pair; empty on pages
};

/// A pause between two things.
enum class PauseKind {
  Black,   ///< nothing to see
  Rest,    ///< a countdown
  Break,   ///< a countdown, then until the participant wishes to go on
  First,   ///< a word: the first of two stimuli follows
  Second,  ///< likewise
  Held,    ///< the experimenter pauses: words, until `over`
  Trouble  ///< what is wrong keeps a trial from being shown: words, until `over` or, without it, a button
};

/// How long the word before a stimulus of a pair stands, and the black between it and the stimulus, s.
inline constexpr double word_s = 1, after_word_s = 0.5;

struct Pause {
  PauseKind kind = PauseKind::Black;
  double seconds = 0;
  std::string title{}, text{};  ///< shown with the countdown; empty: whatever the display says at such a time
  std::function<bool()> over{};  ///< Held, Trouble: asked again and again
};

/// What is said when a session ends before its last unit, in the display's words.
enum class Notice {
  Over,         ///< it was stopped: nothing more is shown, and a rest until one feels well
  Refused,      ///< no consent: the page of thanks
  NotEligible,  ///< ruled out by an answer: likewise
  Kept,         ///< thanks after a stop: what was given stays
  Deleted,      ///< likewise: what was given is deleted
  Goodbye       ///< likewise: nothing was given
};

/// What is asked then; the answer is yes or no.
enum class Offer {
  StayOut,        ///< is it meant that consent is refused?
  Questionnaire,  ///< a page on how one feels now?
  Keep            ///< shall be kept what was given, and not deleted?
};

/// Asked often while a person may be waiting; throws Stopped to end the session there.
using Check = std::function<void()>;

/// Thrown by a participant who leaves for good: the session ends there (EarlyEnd::DroppedOut).
class Left : public std::runtime_error {
 public:
  Left() : std::runtime_error("the participant left") {}
};

class Participant {
 public:
  virtual ~Participant() = default;
  /// The specification of a simulated observer, complete with its defaults; none for a person.
  virtual std::optional<std::string> simulated() const = 0;
  /// Shows a text until the participant goes on, not before `least_s`.
  virtual void read(const Block& block, double least_s, Clock& clock, const Check& check) = 0;
  /// Asks `questions` on one page. One answer each, on its scale or within its rules.
  virtual std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                                       const Occasion& occasion, Clock& clock, const Check& check) = 0;
  /// Called before each showing of a trial; may throw Left.
  virtual void before_trial(const Occasion&) {}
  /// Waits on `clock`, and for a Break until the participant goes on.
  virtual void pause(const Pause& pause, Clock& clock, const Check& check) = 0;
  /// Shows a page that ends a session, not less than `least_s`. After all but Over the session's pages are
  /// done.
  virtual void tell(Notice, double /*least_s*/, Clock&, const Check&) {}
  virtual bool offer(Offer, Clock&, const Check&) { return true; }
};

}  // namespace study
