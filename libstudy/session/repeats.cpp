#include "libstudy/session/repeats.hpp"

#include <cmath>

#include "libstudy/session/recording.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {
constexpr const char* rate_mend =
    "set the refresh rate of the study in the headset's software, and fix it there";
}

void Repeats::begin_trial() {
  cuts_ = 0;
  require_rate();
  require_eyes();
}

void Repeats::after_cut(CutCause cause) {
  if (cause == CutCause::Gaze) eyes_seen_ = false;
  if (++cuts_ > most_repeats) {
    const CutWords words = words_of(cause);
    pause({"a trial was cut " + std::to_string(cuts_) + " times, the last time because " + words.happened,
           words.mend});
    cuts_ = 0;
  }
  require_rate();
  require_eyes();
  const Check check = [this] { poll_requests(run_, false); };
  run_.parts.participant.pause({PauseKind::Black, black_after_cut_s}, run_.parts.clock, check);
}

void Repeats::require_rate() {
  const Display& display = run_.parts.display;
  const auto& asked_hz = run_.protocol.headset.refresh_hz;
  const std::string place = asked_hz ? " at the protocol's refresh_hz = " + base::shortest(*asked_hz) : "";
  const Check check = [this] { poll_requests(run_, false); };
  while (!comes_true(
      run_, [&display] { return display.keeps_rate(); }, rate_within_s, check))
    pause({"the display's refresh rate does not settle" + place, rate_mend});
}

void Repeats::wait_for_rate() {
  const double hz = std::round(100 * run_.parts.display.measured_hz()) / 100;
  pause({"the display's refresh rate changed to " + base::shortest(hz) +
             " Hz, at which the trial cannot be shown",
         rate_mend});
}

void Repeats::require_eyes() {
  const Check check = [this] { poll_requests(run_, false); };
  while (!eyes_seen_) {
    eyes_seen_ = sees_eyes(run_, eyes_within_s, check);
    if (eyes_seen_) continue;
    const std::string trouble = run_.parts.gaze->trouble();
    pause(trouble.empty() ? Trouble{"the eye tracker does not see the eyes",
                                    "check how the headset sits, and calibrate the eye tracker"}
                          : Trouble{trouble,
                                    "start the eye tracker's sender again; vip-study gaze --test "
                                    "tries it"});
  }
}

void Repeats::pause(const Trouble& trouble) {
  eyes_seen_ = false;
  const SessionParts& parts = run_.parts;
  parts.store.log(run_.session.id, "paused by the program", trouble.what, run_.now_ns());
  if (parts.participant.simulated())
    throw base::Error("session of " + run_.session.plan.participant, trouble.what,
                      trouble.mend + "; vip-study resume continues the session");
  const bool held = run_.hooks.trouble && run_.hooks.trouble(trouble);
  Pause pause{PauseKind::Trouble, 0, {}, {}, {}};
  if (held) pause.over = [this] { return run_.request().kind == Request::GoOn; };
  parts.participant.pause(pause, parts.clock, [this] { poll_requests(run_, false); });
  parts.store.log(run_.session.id, "goes on after a pause", "", run_.now_ns());
}

}  // namespace study
