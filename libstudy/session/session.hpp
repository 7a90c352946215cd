#pragma once
/// One participant's way through the plan: pages, schedules, trials, verdicts, questions, answers.

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

/// Gives the stimulus of a cell, ready to start. Its caller keeps it until the next call.
class StimulusSource {
 public:
  virtual ~StimulusSource() = default;
  virtual Stimulus& stimulus(const Cell& cell) = 0;
};

/// What a session is given; it owns none of it.
struct SessionParts {
  Clock& clock;
  Display& display;
  StimulusSource& stimuli;
  Participant& participant;
  Store& store;
  PersonalFile* personal = nullptr;  ///< needed where the protocol asks something personal
  bool virtual_clock = false;
  /// Recorded while a stimulus is shown to who allows it. Without: nothing is measured.
  GazeSource* gaze = nullptr;
  SlotSource* slots = nullptr;     ///< the headset, where there is one
  GazeTargets* targets = nullptr;  ///< to validate the eye tracker by, where there is one
};

/// What happened to a unit, told once it is committed. Answers themselves stay in the store.
struct UnitDone {
  std::string participant;
  PlannedUnit unit;
  int attempt = 0;                      ///< of a trial, from 1
  std::vector<TimingVerdict> verdicts;  ///< one for each stimulus of a trial
};

/// What experimenter and display wish, asked after every frame and often in every pause.
struct Wish {
  enum Kind {
    GoOn,
    Stop,        ///< end the program; the session can be resumed
    EndSession,  ///< a rest, then no further unit (Store::end_session)
    Cut,         ///< cut this trial, for this cause, and show it again
    Pause        ///< before the next unit, until the wish changes
  };
  Wish(Kind what) : kind(what) {}
  Wish(CutCause why) : kind(Cut), cause(why) {}
  bool operator==(const Wish&) const = default;

  Kind kind;
  CutCause cause{};  ///< of Cut
};

/// What keeps a trial from being shown.
struct Trouble {
  std::string what, mend;  ///< for the experimenter
};

struct SessionHooks {
  std::function<void(const OpenUnit&)> begins;
  std::function<void(const FrameRecord&)> shown;
  std::function<void(const UnitDone&)> done;
  std::function<void(const Ending&)> ends;  ///< early; committed, and say_farewell() comes next
  std::function<Wish()> wish;
  /// The session pauses; to be said to the experimenter. True: somebody is there who ends the pause, and
  /// wish() is Pause until then. False, or without: the participant's page has a button to go on.
  std::function<bool(const Trouble&)> trouble;
};

/// The session was asked to stop. Everything up to then is in the store.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

/// The intervals that a setting becomes on this display, nanoseconds. base::Error when it cannot be shown
/// there: no schedule has these moments, or a fixed refresh misses them and the protocol does not accept
/// that.
std::vector<std::int64_t> trial_intervals(const Protocol& protocol, const FpsSetting& setting,
                                          const Display& display, std::uint64_t schedule_seed);

/// Throws what trial_intervals() would for any setting of the protocol: asked before anything is written.
void check_settings(const Protocol& protocol, const Display& display);

/// Goes through the units of `session` that are not done, in their order. A trial that was cut short is shown
/// again from its start, as a new attempt, as often as repeats.hpp allows; what was answered is never asked
/// again. An answer that a question
/// does not accept ends the session (EarlyEnd::Refused on a page of consent, once the participant has said
/// that it is meant, else EarlyEnd::NotEligible), one at its stop_at as well (EarlyEnd::Stopped). Returns how
/// it ended early, if it did; say_farewell() was then called. Throws Stopped, or the first failure of a part;
/// the store then holds all answers given.
std::optional<Ending> run_session(const Protocol& protocol, const OpenSession& session,
                                  const SessionParts& parts, const SessionHooks& hooks);

}  // namespace study
