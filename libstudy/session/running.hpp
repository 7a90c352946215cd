#pragma once
/// State that the parts of a running session share, and the exception that cuts a trial.

#include <functional>
#include <string>

#include "libstudy/session/marking.hpp"
#include "libstudy/session/session.hpp"

namespace study {

struct Running {
  const Protocol& protocol;
  const OpenSession& session;
  const SessionParts& parts;
  const SessionHooks& hooks;
  Marking& marking;

  Request request() const { return hooks.request ? hooks.request() : Request::GoOn; }
  std::int64_t now_ns() const { return parts.clock.now_ns(); }
  const Block& block(const OpenUnit& unit) const {
    return protocol.blocks.at(static_cast<std::size_t>(unit.plan.block));
  }
  Occasion occasion(const OpenUnit& unit) const {
    return {session.plan.participant, session.plan.seed, unit.plan.position, block(unit).kind, {}};
  }
  void tell(const OpenUnit& unit, int attempt, const std::vector<TimingVerdict>& verdicts) const {
    if (hooks.done) hooks.done({session.plan.participant, unit.plan, attempt, verdicts});
  }
};

/// Thrown to cut a trial and show it again.
struct TrialAgain {
  CutCause cause;
  std::string news{};  ///< names of the headset's events that were logged just before the cut; may be empty

  /// Text of the cause for notes and the log.
  std::string reason() const { return words_of(cause).happened + (news.empty() ? news : ": " + news); }
};

/// Acts on the current request: Stop throws Stopped, EndSession throws Ending, Cut throws TrialAgain if
/// `in_trial`. Before acting, logs the events of the headset and the eye tracker.
void poll_requests(const Running& run, bool in_trial);

}  // namespace study
