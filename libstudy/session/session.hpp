#pragma once
/// Runs one participant's plan: pages, schedules, trials, verdicts, questions, answers.

#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/cut_cause.hpp"
#include "libstudy/display/gaze.hpp"
#include "libstudy/display/gaze_targets.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/participant.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Provides the stimulus of a cell, ready to start; it is valid until the next call.
class StimulusSource {
 public:
  virtual ~StimulusSource() = default;
  virtual Stimulus& stimulus(const Cell& cell) = 0;
};

/// The parts that a session uses; it owns none of them.
struct SessionParts {
  Clock& clock;
  Display& display;
  StimulusSource& stimuli;
  Participant& participant;
  Store& store;
  PersonalFile* personal = nullptr;  ///< required if the protocol asks a personal question
  bool virtual_clock = false;
  /// Recorded during stimuli if the participant allows it. Null: no gaze is recorded.
  GazeSource* gaze = nullptr;
  SlotSource* slots = nullptr;     ///< the headset, or null
  GazeTargets* targets = nullptr;  ///< for validating the eye tracker, or null
};

/// Reports a finished unit once it is committed. It holds no answers.
struct UnitDone {
  std::string participant;
  PlannedUnit unit;
  int attempt = 0;                      ///< of a trial, from 1
  std::vector<TimingVerdict> verdicts;  ///< one for each stimulus of a trial
};

/// Request of the experimenter or the display, polled after every frame and often in every pause.
struct Request {
  enum Kind {
    GoOn,
    Stop,        ///< end the program; the session can be resumed
    EndSession,  ///< a rest, then no further unit (Store::end_session)
    Cut,         ///< cut this trial, for this cause, and show it again
    Pause        ///< wait before the next unit until the wish changes
  };
  Request(Kind what) : kind(what) {}
  Request(CutCause why) : kind(Cut), cause(why) {}
  bool operator==(const Request&) const = default;

  Kind kind;
  CutCause cause{};  ///< of Cut
};

/// A problem that prevents a trial.
struct Trouble {
  std::string what, mend;  ///< for the experimenter
};

struct SessionHooks {
  std::function<void(const OpenUnit&)> begins;
  std::function<void(const FrameRecord&)> shown;
  std::function<void(const UnitDone&)> done;
  std::function<void(const Ending&)> ends;  ///< an early end is committed; say_farewell() comes next
  std::function<Request()> request;
  /// Tells the experimenter why the session pauses. True: the experimenter ends the pause, and request() is
  /// Pause until then. False, or no hook: the participant's page has a button to go on.
  std::function<bool(const Trouble&)> trouble;
};

/// The session was asked to stop. Everything up to then is in the store.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

/// The frame intervals of a setting on this display, nanoseconds. base::Error if it cannot be shown there: no
/// schedule has these moments, or a fixed refresh misses them and the protocol does not accept that.
std::vector<std::int64_t> trial_intervals(const Protocol& protocol, const FpsSetting& setting,
                                          const Display& display, std::uint64_t schedule_seed);

/// Throws if trial_intervals() would for any setting of the protocol. Call before anything is written.
void check_settings(const Protocol& protocol, const Display& display);

/// Goes through the units of `session` that are not done, in their order. A trial that was cut is shown again
/// from its start, as a new attempt, as often as repeats.hpp allows. Pages that were answered are not asked
/// again. An answer outside a question's accept range ends the session (EarlyEnd::Refused on a consent page,
/// after confirmation, else EarlyEnd::NotEligible); so does one at its stop_at (EarlyEnd::Stopped). Returns
/// how the session ended early, if it did, after say_farewell(). Throws Stopped, or the first failure of a
/// part; the store then holds all answers given.
std::optional<Ending> run_session(const Protocol& protocol, const OpenSession& session,
                                  const SessionParts& parts, const SessionHooks& hooks);

}  // namespace study
