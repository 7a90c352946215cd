#include "libstudy/session/trial_player.hpp"

#include <algorithm>
#include <cmath>

#include "libstudy/session/frame_journal.hpp"
#include "libstudy/session/recording.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

int cell_index(const PlannedTrial& trial, int interval) {
  return interval == 0 ? trial.first : trial.second.value();
}

/// Simulated time between the first and the last frame, divided by the display time between them. Steps back
/// in simulated time do not count.
double play_speed(const PlayedTrial& played, TimingGrade grade) {
  double simulated_s = 0;
  for (std::size_t i = 1; i < played.frames.size(); ++i) {
    simulated_s += std::max(
        0.0, played.frames[i].facts.simulation_time_s - played.frames[i - 1].facts.simulation_time_s);
  }
  const auto shown_ns =
      placed_ns(played.frames.back().times, grade) - placed_ns(played.frames.front().times, grade);
  return shown_ns > 0 ? simulated_s / (1e-9 * static_cast<double>(shown_ns)) : 0;
}

/// The setting with which the timing of a showing is compared. If the setting has a pattern, its mean and
/// standard deviation are replaced by those of the intervals planned for this display.
FpsSetting shown_setting(FpsSetting setting, FpsMean mean, const std::vector<std::int64_t>& intervals_ns) {
  if (!has_pattern(setting)) return setting;
  std::vector<double> seconds;
  for (const std::int64_t ns : intervals_ns) seconds.push_back(1e-9 * static_cast<double>(ns));
  const stats::FpsMoments moments = stats::fps_moments(seconds);
  setting.mean = moments.mean_of(mean);
  setting.sd = moments.sd;
  return setting;
}

/// Mean absolute difference, ms, between the simulated time and the display time from one frame to the next.
/// Rewinds and frames before the content first advances do not count. 0 if no pair of frames counts.
double animation_error_ms(const PlayedTrial& played, TimingGrade grade) {
  double sum_s = 0;
  int count = 0;
  for (std::size_t i = 1; i < played.frames.size(); ++i) {
    const FrameRecord &a = played.frames[i - 1], &b = played.frames[i];
    const double simulated_s = b.facts.simulation_time_s - a.facts.simulation_time_s;
    // Content with a latency (ContentRules::latency_s) stands still until the latency has passed.
    const bool begun = b.facts.simulation_time_s > played.frames.front().facts.simulation_time_s;
    if (simulated_s < 0 || !begun) continue;
    sum_s += std::abs(simulated_s -
                      1e-9 * static_cast<double>(placed_ns(b.times, grade) - placed_ns(a.times, grade)));
    ++count;
  }
  return count > 0 ? 1e3 * sum_s / count : 0;
}

std::vector<Question> questions_of(const Protocol& protocol, const std::vector<std::string>& ids) {
  const auto all = all_questions(protocol);
  std::vector<Question> out;
  for (const std::string& id : ids) {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.second->id == id; });
    out.push_back(*found->second);
  }
  return out;
}

/// Describes, for the log, why the current exception cuts a showing.
std::string reason_of_cut() {
  try {
    throw;
  } catch (const TrialAgain& again) {
    return again.reason();
  } catch (const Stopped&) {
    return "the program was stopped on request";
  } catch (const Ending&) {
    return "the session was ended";
  } catch (const DisplayGone& gone) {
    return words_of(gone.cause()).happened;
  } catch (...) {
    return "an error ended the program";
  }
}

class Cleared {
 public:
  explicit Cleared(Display& display) : display_(display) {}
  ~Cleared() { display_.clear(); }
  Cleared(const Cleared&) = delete;
  Cleared& operator=(const Cleared&) = delete;

 private:
  Display& display_;
};

}  // namespace

const Cell& TrialPlayer::cell(const OpenUnit& unit, int interval) const {
  return run_.protocol.design.cells.at(static_cast<std::size_t>(cell_index(*unit.trial, interval)));
}

std::array<std::vector<std::int64_t>, 2> TrialPlayer::intervals_of(const PlannedTrial& trial) const {
  std::array<std::vector<std::int64_t>, 2> out;
  if (run_.protocol.design.timing == TimingSource::Native) return out;
  for (const int interval : {0, 1}) {
    if (interval == 1 && !trial.second) continue;
    const Cell& shown = run_.protocol.design.cells.at(static_cast<std::size_t>(cell_index(trial, interval)));
    out[static_cast<std::size_t>(interval)] =
        trial_intervals(run_.protocol, shown.setting, run_.parts.display,
                        trial.schedule_seed + static_cast<std::uint64_t>(interval));
  }
  return out;
}

std::optional<Ending> TrialPlayer::play(OpenUnit unit) {
  if (run_.protocol.design.procedure && run_.block(unit).kind == BlockKind::Stimulus) choose(unit);
  Showing showing{unit, unit.attempts + 1, {}, {}, {}};
  repeats_.begin_trial();
  for (;;) {
    showing.occasion = run_.occasion(unit);
    run_.marking.enter(unit.plan.position, showing.attempt);
    try {
      return play_marked(showing);
    } catch (const TrialAgain& cut) {
      again(showing, cut.reason());
      repeats_.after_cut(cut.cause);
    } catch (const DisplayGone& gone) {
      note_end(unit, gone.cause());
      throw;
    }
  }
}

/// Lets the protocol's adaptive procedure choose the cells of a trial from the answers so far. After an
/// interruption the answers are the same, so the procedure chooses the same cells again, unless answers of an
/// earlier session were added or deleted meanwhile.
void TrialPlayer::choose(OpenUnit& unit) {
  Store& store = run_.parts.store;
  const Procedure& procedure = *run_.protocol.design.procedure;
  TrackAnswers answers{store.track_answers(run_.session.id, procedure.question)};
  if (procedure.kind == ProcedureKind::Ptpe) {
    answers.earlier = store.earlier_answers(run_.session.id, procedure.question);
    answers.person = static_cast<int>(run_.session.id);
  }
  const PlannedTrial chosen = chosen_trial(run_.protocol, *unit.trial, answers);
  if (chosen.first != unit.trial->first || chosen.second != unit.trial->second)
    store.choose_cells(run_.session.id, unit.trial_id, chosen.first, chosen.second);
  unit.trial = chosen;
}

void TrialPlayer::again(Showing& showing, const std::string& reason) {
  run_.parts.store.repeat_trial(run_.session.id, showing.unit.trial_id, reason);
  showing.unit.answered.clear();
  ++showing.attempt;
  showing.verdicts.clear();
  showing.ready = nullptr;
  showing.next_interval = 0;
}

/// Notes why a trial was cut by the end of the program. A store that fails too must not hide the error that
/// ends the program.
void TrialPlayer::note_end(const OpenUnit& unit, CutCause cause) const {
  try {
    run_.parts.store.note(run_.session.id, unit.id, words_of(cause).happened);
  } catch (const std::exception&) {
  }
}

/// The session was refused where a setting could not be shown at its first refresh rate. At another rate it
/// pauses until the trial can be shown.
void TrialPlayer::compute_intervals(Showing& showing) {
  for (;;) {
    try {
      showing.intervals = intervals_of(*showing.unit.trial);
      return;
    } catch (const base::Error&) {
      if (run_.parts.display.refresh_hz() == first_hz_) throw;
    }
    repeats_.wait_for_rate();
  }
}

std::optional<Ending> TrialPlayer::play_marked(Showing& showing) {
  run_.marking.mark(MarkerKind::TrialBegin);
  try {
    auto ends = play_steps(showing);
    run_.marking.mark(MarkerKind::TrialEnd);
    return ends;
  } catch (...) {
    run_.marking.mark(MarkerKind::Cut);
    throw;
  }
}

std::optional<Ending> TrialPlayer::play_steps(Showing& showing) {
  run_.parts.participant.before_trial(showing.occasion);
  const Block& block = run_.block(showing.unit);
  const Check check = [this] { poll_requests(run_, true); };
  const auto shows = [](const TrialStep& step) { return step.kind == StepKind::Stimulus; };
  for (std::size_t i = 0; i < block.steps.size(); ++i) {
    const TrialStep& step = block.steps[i];
    check();
    // Computed again for each showing, because the refresh rate of the display may change at a cut.
    if (i == 0) compute_intervals(showing);
    switch (step.kind) {
      case StepKind::Black:
        black(showing, step.seconds,
              std::any_of(block.steps.begin() + static_cast<std::ptrdiff_t>(i), block.steps.end(), shows));
        break;
      case StepKind::Stimulus:
        show(showing, step.interval);
        break;
      case StepKind::Ask:
        if (auto ends = ask(showing, i)) return ends;
        break;
      case StepKind::Rest:
        run_.parts.participant.pause({PauseKind::Rest, step.seconds}, run_.parts.clock, check);
        break;
    }
  }
  return {};
}

/// Shows a black screen for `seconds`. If a stimulus follows, prepares it meanwhile, because this may be
/// slow.
void TrialPlayer::black(Showing& showing, double seconds, bool stimulus_follows) {
  const Check check = [this] { poll_requests(run_, true); };
  const std::int64_t begun_ns = run_.now_ns();
  if (stimulus_follows && !showing.ready) {
    run_.parts.participant.pause({PauseKind::Black, 0}, run_.parts.clock, check);
    make_ready(showing);
  }
  const double gone_s = 1e-9 * static_cast<double>(run_.now_ns() - begun_ns);
  run_.parts.participant.pause({PauseKind::Black, std::max(0.0, seconds - gone_s)}, run_.parts.clock, check);
}

void TrialPlayer::announce(int interval) {
  const PauseKind word = interval == 0 ? PauseKind::First : PauseKind::Second;
  run_.parts.participant.pause({word, word_s}, run_.parts.clock, [this] { poll_requests(run_, true); });
}

void TrialPlayer::make_ready(Showing& showing) {
  showing.ready = &run_.parts.stimuli.stimulus(cell(showing.unit, showing.next_interval));
  showing.ready->start(run_.protocol.content.start_frame);
}

void TrialPlayer::show(Showing& showing, int interval) {
  showing.next_interval = interval;
  const bool pair = showing.unit.trial->second.has_value();
  if (pair) announce(interval);
  if (pair || !showing.ready) black(showing, pair ? after_word_s : 0, true);
  const Cell& what = cell(showing.unit, interval);
  ShownStimulus shown{cell_index(*showing.unit.trial, interval), what, {}, 0, 0};
  const std::int64_t start_ns = run_.now_ns();
  const std::int64_t presentation =
      run_.parts.store.begin_presentation(run_.session.id, showing.unit.trial_id, showing.attempt, interval,
                                          shown.cell, start_ns, Recording::followed(run_));
  run_.marking.next_stimulus(interval + 1);
  showing.verdicts.push_back(present(presentation, start_ns, what,
                                     showing.intervals[static_cast<std::size_t>(interval)], *showing.ready,
                                     shown));
  showing.occasion.shown.push_back(shown);
  showing.ready = nullptr;
  showing.next_interval = interval + 1;
}

TimingVerdict TrialPlayer::judge(const Cell& cell, const std::vector<std::int64_t>& intervals,
                                 const PlayedTrial& played) const {
  const TimingGrade grade = run_.parts.display.grade();
  if (run_.protocol.design.timing == TimingSource::Native) return describe_trial(played, grade);
  const PacingRules rules = for_display(run_.protocol.pacing, run_.parts.display.refresh_hz());
  return judge_trial(shown_setting(cell.setting, rules.mean, intervals), rules, played, run_.protocol.timing,
                     grade);
}

TimingVerdict TrialPlayer::present(std::int64_t presentation, std::int64_t start_ns, const Cell& cell,
                                   const std::vector<std::int64_t>& intervals, Stimulus& stimulus,
                                   ShownStimulus& shown) const {
  const SessionParts& parts = run_.parts;
  const Cleared cleared(parts.display);
  Recording recording(run_);
  FrameJournal journal(parts.store, {run_.session.id, presentation, start_ns}, recording.origin(),
                       !parts.virtual_clock);
  const auto each = [&](const FrameRecord& frame) {
    if (frame.index == 0) run_.marking.onset(frame.times);
    journal.add(frame, recording.take());
    if (run_.hooks.shown) run_.hooks.shown(frame);
    poll_requests(run_, true);
    recording.require_gaze();
  };
  try {
    const double duration_s = cell.setting.duration_s;
    const ShowingBounds bounds = showing_bounds(run_.protocol.timing, duration_s);
    const ContentRules content = content_of(run_.protocol.content, cell.setting);
    const PlayedTrial played =
        intervals.empty()
            ? play_native(duration_s, content, stimulus, parts.display, parts.clock, bounds.overrun_ns, each)
            : play_trial(intervals, content, stimulus, parts.display, parts.clock, bounds, each);
    TimingVerdict verdict = judge(cell, intervals, played);
    if (content.real_time) verdict.animation_error_ms = animation_error_ms(played, verdict.grade);
    const Recorded last = recording.take();
    recording.require_gaze();
    parts.store.end_presentation(presentation, start_ns, played.end_ns, journal.finish(last), verdict);
    shown.realised = verdict.realised;
    shown.longest_ms = verdict.longest_ms;
    shown.play_speed = play_speed(played, verdict.grade);
    return verdict;
  } catch (...) {
    // Stores the rest of the frames and the reason of the cut. If this fails too, the next Store::open_runs()
    // marks the presentation as interrupted. Gaze samples after the last frame are not stored.
    const std::string reason = reason_of_cut();
    try {
      parts.store.add_frames(presentation, start_ns, journal.finish({}));
      parts.store.interrupt_presentation(run_.session.id, presentation, reason, run_.now_ns());
    } catch (const std::exception&) {
    }
    throw;
  }
}

std::optional<Ending> TrialPlayer::ask(Showing& showing, std::size_t step) {
  const Block& block = run_.block(showing.unit);
  const bool last =
      std::none_of(block.steps.begin() + static_cast<std::ptrdiff_t>(step) + 1, block.steps.end(),
                   [](const TrialStep& later) { return later.kind == StepKind::Ask; });
  auto ends =
      questioning_.ask(showing.unit, showing.attempt, questions_of(run_.protocol, block.steps[step].asks),
                       showing.occasion, last, [this] { poll_requests(run_, true); });
  if (last) run_.tell(showing.unit, showing.attempt, showing.verdicts);
  return ends;
}

}  // namespace study
