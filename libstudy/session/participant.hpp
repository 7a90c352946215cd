#pragma once
/// The participant's interface: a person at a window or a simulated observer. Both go through the same pages.

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
  double play_speed = 0;       ///< simulated time divided by time shown
};

/// The context of a question: who is asked, where in the session, and what was shown.
struct Occasion {
  std::string participant;
  std::uint64_t seed = 0;
  int position = 0;  ///< of the unit in the session
  BlockKind block = BlockKind::Stimulus;
  std::vector<ShownStimulus> shown;  ///< one, or two of a pair; empty on pages
};

/// A pause between two units or steps.
enum class PauseKind {
  Black,   ///< a black screen
  Rest,    ///< a countdown
  Break,   ///< a countdown, then waits for the participant
  First,   ///< a word announces the first of two stimuli
  Second,  ///< a word announces the second
  Held,    ///< paused by the experimenter: a text until `over`
  Trouble  ///< a problem prevents a trial: a text until `over` or, without it, a button
};

/// Durations of the word before a stimulus of a pair and of the black screen after it, s.
inline constexpr double word_s = 1, after_word_s = 0.5;

struct Pause {
  PauseKind kind = PauseKind::Black;
  double seconds = 0;
  std::string title{}, text{};   ///< shown with the countdown; empty: the display's default
  std::function<bool()> over{};  ///< Held, Trouble: polled
};

/// Pages at the end of a session that ended before its last unit; the display has the words.
enum class Notice {
  Over,         ///< stopped: nothing more is shown; rest until one feels well
  Refused,      ///< no consent: a page of thanks
  NotEligible,  ///< excluded by an answer: a page of thanks
  Kept,         ///< thanks after a stop: the data are kept
  Deleted,      ///< thanks after a stop: the data are deleted
  Goodbye       ///< thanks after a stop: there were no answers
};

/// Questions at such an end, answered yes or no.
enum class Offer {
  StayOut,        ///< confirm that consent is refused?
  Questionnaire,  ///< answer a page on how you feel now?
  Keep            ///< keep the data (no: delete them)?
};

/// Asked often while a person may be waiting; throws Stopped to end the session there.
using Check = std::function<void()>;

/// Thrown if the participant leaves for good: the session ends (EarlyEnd::DroppedOut).
class Left : public std::runtime_error {
 public:
  Left() : std::runtime_error("the participant left") {}
};

class Participant {
 public:
  virtual ~Participant() = default;
  /// The specification of a simulated observer, including defaults; none for a person.
  virtual std::optional<std::string> simulated() const = 0;
  /// Shows a text until the participant goes on, at least for `least_s`.
  virtual void read(const Block& block, double least_s, Clock& clock, const Check& check) = 0;
  /// Asks `questions` on one page. Returns one answer each, valid for its question (is_valid).
  virtual std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                                       const Occasion& occasion, Clock& clock, const Check& check) = 0;
  /// Called before each showing of a trial; may throw Left.
  virtual void before_trial(const Occasion&) {}
  /// Waits on `clock`, and for a Break until the participant goes on.
  virtual void pause(const Pause& pause, Clock& clock, const Check& check) = 0;
  /// Shows a page at a session's end for at least `least_s`. All but Over are the last page.
  virtual void tell(Notice, double /*least_s*/, Clock&, const Check&) {}
  virtual bool offer(Offer, Clock&, const Check&) { return true; }
};

}  // namespace study
