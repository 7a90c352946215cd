#include "libstudy/session/session.hpp"

#include <algorithm>

#include "libstudy/session/questioning.hpp"
#include "libstudy/session/trial_player.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

// After a stop nobody is sent away at once: a rest of at least this long, then until they feel well.
constexpr double stop_rest_s = 60;
constexpr double pause_look_s = 0.1;

/// One session under way.
class SessionRun {
 public:
  explicit SessionRun(const Running& run) : run_(run), questioning_(run), trials_(run, questioning_) {}

  /// Returns how the session ended early, if it did.
  std::optional<Ending> go() {
    for (const OpenUnit& unit : run_.session.units) {
      wait_while_paused();
      if (run_.hooks.begins) run_.hooks.begins(unit);
      if (auto ends = unit.trial ? trials_.play(unit) : page(unit)) return ends;
    }
    return {};
  }

 private:
  void wait_while_paused() {
    const auto check = [this] { heed(run_, false); };
    for (check(); run_.wish() == Wish::Pause;)
      run_.parts.participant.pause({PauseKind::Black, pause_look_s}, run_.parts.clock, check);
  }

  std::optional<Ending> page(const OpenUnit& unit) {
    const Block& block = run_.block(unit);
    const Check check = [this] { heed(run_, false); };
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
      case BlockKind::Stimulus:  // between two groups
        pause({PauseKind::Break, block.between_groups_s}, check);
        break;
      default: {
        auto ends = questioning_.ask(unit, 0, block.questions, run_.occasion(unit), true, check);
        if (!ends || ends->how != EarlyEnd::NotEligible) run_.tell(unit, 0, {});
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
};

void check_personal(const Running& run) {
  const auto all = all_questions(run.protocol);
  const bool asks =
      std::any_of(all.begin(), all.end(), [](const auto& entry) { return entry.second->personal; });
  if (asks && !run.parts.personal) {
    throw base::Error("protocol " + run.protocol.name, "asks something personal, and there is no file for it",
                      "give the session a file of personal data");
  }
}

void rest_after_stop(const Running& run) {
  run.parts.participant.pause({PauseKind::Break, stop_rest_s}, run.parts.clock, [&run] {
    if (run.wish() == Wish::Stop) throw Stopped();
  });
}

}  // namespace

void run_session(const Protocol& protocol, const OpenSession& session, const SessionParts& parts,
                 const SessionHooks& hooks) {
  const Running run{protocol, session, parts, hooks};
  check_personal(run);
  std::optional<Ending> ends;
  try {
    ends = SessionRun(run).go();
  } catch (const Ending& wished) {
    parts.store.end_session(session.id, wished, run.now_ns());
    ends = wished;
  } catch (const Left& left) {
    parts.store.end_session(session.id, {EarlyEnd::DroppedOut, left.what()}, run.now_ns());
  }
  if (ends && ends->how == EarlyEnd::Stopped) rest_after_stop(run);
}

}  // namespace study
