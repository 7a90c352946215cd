#pragma once
/// One participant's way through the plan: gap, schedule, trial, verdict, question, answer.

#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "libstudy/display/stimulus.hpp"
#include "libstudy/observer/responder.hpp"
#include "libstudy/pacing/clock.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"
#include "stats/ptpe.hpp"

namespace study {

/// What a session is given; it owns none of it.
struct SessionParts {
  Clock& clock;
  Display& display;
  Stimulus& stimulus;
  Responder& responder;
  Store& store;
  bool virtual_clock = false;
  /// The PTPE model in force: each frame's record then holds tau (RunningTolerance).
  std::optional<stats::PtpeModel> ptpe = {};
};

/// What happened to a trial, told once its answer is committed. The answer itself stays in the store.
struct TrialDone {
  std::string participant;
  int position = 0;
  int attempt = 1;
  TimingVerdict verdict;
};

struct SessionHooks {
  std::function<void(const TrialDone&)> answered;
  /// Asked after every frame and in every gap; true ends the session at that frame.
  std::function<bool()> stop;
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

/// Shows and asks the trials of `session` that have no answer yet, in their order. A trial that was cut short
/// is shown again from its start, as a new attempt; an answered one is never asked again.
/// Throws Stopped, or the first failure of a part; the store then holds all answers given.
void run_session(const Protocol& protocol, const OpenSession& session, const SessionParts& parts,
                 const SessionHooks& hooks);

}  // namespace study
