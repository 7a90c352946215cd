#pragma once
/// The interface to the participant, who is a person or a simulated observer. Both get the same pages.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/fps_window.hpp"

namespace study {

/// One shown stimulus and its measured timing.
struct ShownStimulus {
  int cell = 0;  ///< index into Design::cells
  Cell what;
  stats::FpsMoments realised;  ///< mean and standard deviation of the shown frame rate
  double longest_ms = 0;       ///< longest interval between two frames
  double play_speed = 0;       ///< simulated time divided by display time
};

/// The context of a question: the participant, the position in the session, and the shown stimuli.
struct Occasion {
  std::string participant;
  std::uint64_t seed = 0;
  int position = 0;  ///< position of the unit in the session
  BlockKind block = BlockKind::Stimulus;
  std::vector<ShownStimulus> shown;  ///< the trial's stimuli; empty on a page outside trials
};

/// A pause between two units or steps.
enum class PauseKind {
  Black,   ///< a black screen
  Rest,    ///< a countdown
  Break,   ///< a countdown, then a page until the participant continues
  First,   ///< a word announces the first of two stimuli
  Second,  ///< a word announces the second of two stimuli
  Held,    ///< paused by the experimenter: a text until Pause::over() is true
  /// a problem prevents a trial: a text until Pause::over() is true or, if `over` is empty, until a button is
  /// pressed
  Trouble
};

/// Durations of the word before a stimulus of a pair and of the black screen after the word, s.
inline constexpr double word_s = 1, after_word_s = 0.5;

struct Pause {
  PauseKind kind = PauseKind::Black;
  double seconds = 0;
  std::string title{}, text{};   ///< heading and text shown with the countdown; empty: the display's default
  std::function<bool()> over{};  ///< Held, Trouble: true ends the pause
};

/// Pages after a session that ended before its last unit. The participant's display supplies the texts.
enum class Notice {
  Over,         ///< the session was stopped: asks the participant to rest until well
  Refused,      ///< no consent: a page of thanks
  NotEligible,  ///< an answer excluded the person: a page of thanks
  Kept,         ///< thanks after a stop: the data are kept
  Deleted,      ///< thanks after a stop: the data are deleted
  Goodbye       ///< thanks after a stop: there were no answers
};

/// Questions with the answers yes and no when a session ends before its last unit.
enum class Offer {
  StayOut,        ///< does the participant really refuse consent?
  Questionnaire,  ///< would you answer a page about how you feel?
  Keep            ///< may the data be kept? no: they are deleted
};

/// Function that is called often while the session waits for a person. It throws to end the wait: Stopped to
/// end the program, Ending to end the session, TrialAgain (running.hpp) to cut the trial.
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
  /// Shows the block's text for at least `least_s`, until the participant continues.
  virtual void read(const Block& block, double least_s, Clock& clock, const Check& check) = 0;
  /// Asks `questions` on one page. Returns one answer for each question, in their order; every answer is
  /// valid (is_valid).
  virtual std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                                       const Occasion& occasion, Clock& clock, const Check& check) = 0;
  /// Called before each showing of a trial. Throws Left if the participant leaves the study.
  virtual void before_trial(const Occasion&) {}
  /// Waits on `clock` until the pause is over; a Break also waits until the participant continues.
  virtual void pause(const Pause& pause, Clock& clock, const Check& check) = 0;
  /// Shows the page of a notice after the session's end, for at least `least_s`. A page of any notice except
  /// Over is the participant's last page.
  virtual void tell(Notice, double /*least_s*/, Clock&, const Check&) {}
  virtual bool offer(Offer, Clock&, const Check&) { return true; }

  /// Sets the function that ask() calls once its page is on the display. Participants without pages never
  /// call it.
  void when_shown(std::function<void()> shown) { shown_ = std::move(shown); }

 protected:
  void page_is_shown() const {
    if (shown_) shown_();
  }

 private:
  std::function<void()> shown_;
};

}  // namespace study
