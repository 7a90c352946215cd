#include "libstudy/session/session.hpp"

#include <algorithm>

#include "libstudy/session/farewell.hpp"
#include "libstudy/session/gaze_validation.hpp"
#include "libstudy/session/recording.hpp"
#include "libstudy/session/trial_player.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// A running session.
class SessionRun {
 public:
  explicit SessionRun(const Running& run) : run_(run), questioning_(run), trials_(run, questioning_) {}

  /// Returns how the session ended early, if it did; the end is committed.
  std::optional<Ending> go() {
    try {
      return units();
    } catch (const Ending& wished) {
      return end(wished);
    } catch (const Left& left) {
      return end({EarlyEnd::DroppedOut, left.what()});
    }
  }

  void say_farewell(const Ending& ending) {
    study::say_farewell(run_, questioning_, ending, std::span(run_.session.units).subspan(under_way_));
  }

 private:
  std::optional<Ending> units() {
    for (under_way_ = 0; under_way_ < run_.session.units.size(); ++under_way_) {
      const OpenUnit& unit = run_.session.units[under_way_];
      wait_while_paused();
      if (run_.hooks.begins) run_.hooks.begins(unit);
      if (auto ends = unit.trial ? trials_.play(unit) : page(unit)) return ends;
    }
    return {};
  }

  Ending end(const Ending& ending) {
    run_.parts.store.end_session(run_.session.id, ending, run_.now_ns());
    return ending;
  }

  void wait_while_paused() {
    const auto check = [this] { poll_requests(run_, false); };
    check();
    const auto over = [this] { return run_.request() != Request::Pause; };
    if (!over()) pause({PauseKind::Held, 0, {}, {}, over}, check);
  }

  std::optional<Ending> page(const OpenUnit& unit) {
    const Block& block = run_.block(unit);
    const Check check = [this] { poll_requests(run_, false); };
    switch (block.kind) {
      case BlockKind::Instructions:
      case BlockKind::Debrief:
        run_.parts.participant.read(block, block.seconds, run_.parts.clock, check);
        break;
      case BlockKind::Rest:
        pause({PauseKind::Rest, block.seconds, block.title, block.text}, check);
        break;
      case BlockKind::Break:
        pause({PauseKind::Break, block.seconds, block.title, block.text}, check);
        break;
      case BlockKind::Black:
        pause({PauseKind::Black, block.seconds}, check);
        break;
      case BlockKind::GazeValidation:
        validate_gaze(run_, block, check);
        break;
      case BlockKind::Stimulus:  // between two groups
        pause({PauseKind::Break, block.between_groups_s}, check);
        break;
      default: {
        auto ends = questioning_.ask(unit, 0, block.questions, run_.occasion(unit), true, check);
        if (!ends || ends->how == EarlyEnd::Stopped) run_.tell(unit, 0, {});
        return ends;
      }
    }
    run_.parts.store.finish_unit(run_.session.id, unit.id, run_.now_ns());
    run_.tell(unit, 0, {});
    return {};
  }

  void pause(const Pause& pause, const Check& check) {
    run_.parts.participant.pause(pause, run_.parts.clock, check);
  }

  const Running& run_;
  Questioning questioning_;
  TrialPlayer trials_;
  std::size_t under_way_ = 0;  ///< index of the unit
};

void check_personal(const Running& run) {
  const auto all = all_questions(run.protocol);
  const bool asks =
      std::any_of(all.begin(), all.end(), [](const auto& entry) { return entry.second->personal; });
  if (asks && !run.parts.personal) {
    throw base::Error("protocol " + run.protocol.name,
                      "asks personal questions, and there is no file for the answers",
                      "give the session a file of personal data");
  }
}

}  // namespace

std::optional<Ending> run_session(const Protocol& protocol, const OpenSession& session,
                                  const SessionParts& parts, const SessionHooks& hooks) {
  const Running running{protocol, session, parts, hooks};
  check_personal(running);
  record_headset(running);
  SessionRun run(running);
  const std::optional<Ending> ending = run.go();
  if (ending && hooks.ends) hooks.ends(*ending);
  if (ending) run.say_farewell(*ending);
  return ending;
}

}  // namespace study
