#pragma once
/// Runs one participant's session: shows the pages and trials of the plan, judges their timing and stores the
/// answers.

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
#include "libstudy/markers/marker.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/session/participant.hpp"
#include "libstudy/store/personal.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Provides the stimulus of a cell. The reference is valid until the next call.
class StimulusSource {
 public:
  virtual ~StimulusSource() = default;
  virtual Stimulus& stimulus(const Cell& cell) = 0;
};

/// The parts that a session uses. The session owns none of them.
struct SessionParts {
  Clock& clock;
  Display& display;
  StimulusSource& stimuli;
  Participant& participant;
  Store& store;
  PersonalFile* personal = nullptr;  ///< file of personal answers; required if the protocol asks for them
  bool virtual_clock = false;
  /// Gaze source, recorded during stimuli if the participant allows gaze. Null: no gaze is recorded.
  GazeSource* gaze = nullptr;
  SlotSource* slots = nullptr;     ///< source of the headset's frame slots; null without a headset
  GazeTargets* targets = nullptr;  ///< targets that validate the eye tracker; null without an eye tracker
};

/// Report of a finished, committed unit. It contains no answers.
struct UnitDone {
  std::string participant;
  PlannedUnit unit;
  int attempt = 0;                      ///< number of the showing of the trial, from 1; 0 for a page
  std::vector<TimingVerdict> verdicts;  ///< one for each stimulus of a trial
};

/// Request of the experimenter or the display, polled after every frame and often in every pause.
struct Request {
  enum Kind {
    GoOn,
    Stop,        ///< end the program; the session can be resumed
    EndSession,  ///< end the session for good (Store::end_session), then show the farewell
    Cut,         ///< cut this trial for `cause` and show it again
    Pause        ///< wait before the next unit until the request changes
  };
  Request(Kind what) : kind(what) {}
  Request(CutCause why) : kind(Cut), cause(why) {}
  bool operator==(const Request&) const = default;

  Kind kind;
  CutCause cause{};  ///< only for Cut
};

/// A problem that prevents a trial and pauses the session.
struct Trouble {
  std::string what, mend;  ///< the problem and its remedy, for the experimenter
};

struct SessionHooks {
  std::function<void(const OpenUnit&)> begins;
  std::function<void(const FrameRecord&)> shown;
  std::function<void(const UnitDone&)> done;
  std::function<void(const Ending&)> ends;  ///< called when an early end is committed, before say_farewell()
  std::function<Request()> request;
  /// Reports to the experimenter why the session pauses. Returns true if the experimenter ends the pause,
  /// which lasts until request() is GoOn. If the hook returns false, or if there is no hook, the
  /// participant's page has a button that ends the pause.
  std::function<bool(const Trouble&)> trouble;
  /// Receives what happens, at once, for recording systems (libstudy/markers). It must not wait.
  std::function<void(const Marker&)> mark;
};

/// Thrown if the session is stopped on request. The store then has all data up to the stop.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

/// The frame intervals of a setting on this display, nanoseconds. base::Error if no schedule has the
/// setting's mean and standard deviation, or if the display's refresh rate permits only an approximation and
/// the protocol does not accept approximate settings.
std::vector<std::int64_t> trial_intervals(const Protocol& protocol, const FpsSetting& setting,
                                          const Display& display, std::uint64_t schedule_seed);

/// Throws the base::Error of trial_intervals() if a setting of the protocol cannot be shown. Accepts every
/// protocol with native timing, which has no schedules. Call before anything is written.
void check_settings(const Protocol& protocol, const Display& display);

/// Runs the units of `session` that are not done, in their order. A trial that was cut is shown again from
/// its start, as a new attempt, as often as repeats.hpp allows; the new attempt asks all its questions.
/// Otherwise answered questions are not asked again. An answer outside Question::accept ends the session:
/// EarlyEnd::Refused on a consent page, after confirmation, else EarlyEnd::NotEligible. A score of
/// Question::stop_at or more ends the session as EarlyEnd::Stopped. If the session ended early, returns the
/// ending after say_farewell(). Throws Stopped, or the first error of a part; the store then has all given
/// answers.
std::optional<Ending> run_session(const Protocol& protocol, const OpenSession& session,
                                  const SessionParts& parts, const SessionHooks& hooks);

}  // namespace study
