#include "libstudy/session/session.hpp"

#include <algorithm>
#include <cmath>

#include "libstudy/pacing/running_tolerance.hpp"
#include "libstudy/session/frame_journal.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr double ns_per_s = 1e9, ns_per_ms = 1e6;
constexpr std::int64_t stop_check_ns = 50'000'000;

/// Hold counts as nanoseconds that add up without drift.
std::vector<std::int64_t> holds_ns(const std::vector<int>& holds, double refresh_hz) {
  std::vector<std::int64_t> intervals;
  std::int64_t periods = 0, before = 0;
  for (const int hold : holds) {
    periods += hold;
    const std::int64_t now = std::llround(static_cast<double>(periods) * ns_per_s / refresh_hz);
    intervals.push_back(now - before);
    before = now;
  }
  return intervals;
}

/// One session under way.
class Runner {
 public:
  Runner(const Protocol& protocol, const OpenSession& session, const SessionParts& parts,
         const SessionHooks& hooks)
      : protocol_(protocol), session_(session), parts_(parts), hooks_(hooks) {}

  void run_trial(const OpenTrial& trial) {
    pause();
    const FpsSetting& setting = protocol_.settings.at(static_cast<std::size_t>(trial.plan.setting));
    const auto intervals = trial_intervals(protocol_, setting, parts_.display, trial.plan.schedule_seed);
    TrialDone done{session_.plan.participant, trial.plan.position, trial.attempts + 1, {}};
    const std::int64_t start_ns = parts_.clock.now_ns();
    const std::int64_t presentation =
        parts_.store.begin_presentation(session_.id, trial.id, done.attempt, start_ns);
    done.verdict = show(presentation, start_ns, setting, intervals);
    ask(trial, presentation, setting, done.verdict);
    if (hooks_.answered) hooks_.answered(done);
  }

 private:
  bool stop_wished() const { return hooks_.stop && hooks_.stop(); }

  void pause() {
    const std::int64_t until = parts_.clock.now_ns() + std::llround(protocol_.gap_s * ns_per_s);
    while (parts_.clock.now_ns() < until) {
      if (stop_wished()) throw Stopped();
      parts_.clock.wait_until(std::min(until, parts_.clock.now_ns() + stop_check_ns));
    }
    if (stop_wished()) throw Stopped();
  }

  TimingVerdict show(std::int64_t presentation, std::int64_t start_ns, const FpsSetting& setting,
                     const std::vector<std::int64_t>& intervals) {
    FrameJournal journal(parts_.store, presentation, start_ns, !parts_.virtual_clock);
    std::optional<RunningTolerance> tolerance;
    if (parts_.ptpe) tolerance.emplace(*parts_.ptpe);
    const auto each = [&](FrameRecord frame) {
      if (tolerance) frame.facts.tolerance = tolerance->next(frame.times.submitted_ns);
      journal.add(frame);
      if (stop_wished()) throw Stopped();
    };
    try {
      const auto late_after_ns = std::llround(protocol_.timing.late_after_ms * ns_per_ms);
      const PlayedTrial played = play_trial(intervals, protocol_.content, parts_.stimulus, parts_.display,
                                            parts_.clock, late_after_ns, each);
      const TimingVerdict verdict =
          judge_trial(setting, for_display(protocol_.pacing, parts_.display.refresh_hz()), played,
                      protocol_.timing, parts_.display.grade());
      parts_.store.end_presentation(presentation, start_ns, played.end_ns, journal.finish(), verdict);
      return verdict;
    } catch (const Stopped&) {
      keep_cut(journal, presentation, start_ns);
      throw;
    }
  }

  void keep_cut(FrameJournal& journal, std::int64_t presentation, std::int64_t start_ns) {
    parts_.store.add_frames(presentation, start_ns, journal.finish());
    parts_.store.interrupt_presentation(session_.id, presentation, parts_.clock.now_ns());
  }

  void ask(const OpenTrial& trial, std::int64_t presentation, const FpsSetting& setting,
           const TimingVerdict& verdict) {
    const Question& question = protocol_.question;
    const ShownTrial shown{session_.plan.participant, session_.plan.seed, trial.plan.position, setting,
                           verdict.realised};
    const std::int64_t asked_ns = parts_.clock.now_ns();
    const Answer answer = parts_.responder.answer(question, shown, parts_.clock);
    if (answer.score < question.scale_min || answer.score > question.scale_max) {
      throw base::Error("question '" + question.id + "'",
                        "was answered with " + std::to_string(answer.score) + ", off its scale",
                        "answer on the scale");
    }
    const std::int64_t now_ns = parts_.clock.now_ns();
    parts_.store.answer(session_.id, trial.id, presentation, question.id, answer.score,
                        static_cast<double>(now_ns - asked_ns) / ns_per_s, now_ns);
  }

  const Protocol& protocol_;
  const OpenSession& session_;
  const SessionParts& parts_;
  const SessionHooks& hooks_;
};

}  // namespace

std::vector<std::int64_t> trial_intervals(const Protocol& protocol, const FpsSetting& setting,
                                          const Display& display, std::uint64_t schedule_seed) {
  const double refresh_hz = display.refresh_hz();
  const PacingRules rules = for_display(protocol.pacing, refresh_hz);
  if (refresh_hz == 0) return compile_schedule(setting, rules, schedule_seed).intervals_ns;

  const RefreshVerdict found = quantise(setting, rules, refresh_hz, schedule_seed);
  const bool shown = found.feasibility == Feasibility::Exact ||
                     (found.feasibility == Feasibility::Approximate && protocol.accept_approximate);
  if (!shown) {
    throw base::Error(protocol.name + " on " + display.description(),
                      "setting " + setting_name(setting) + " cannot be shown: " + found.reason,
                      "see vip-study check --refresh; use another display or accept_approximate = true");
  }
  return holds_ns(found.holds, refresh_hz);
}

void check_settings(const Protocol& protocol, const Display& display) {
  for (const FpsSetting& setting : protocol.settings) trial_intervals(protocol, setting, display, 0);
}

void run_session(const Protocol& protocol, const OpenSession& session, const SessionParts& parts,
                 const SessionHooks& hooks) {
  Runner runner(protocol, session, parts, hooks);
  for (const OpenTrial& trial : session.trials) runner.run_trial(trial);
}

}  // namespace study
