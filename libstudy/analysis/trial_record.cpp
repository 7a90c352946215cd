#include "libstudy/analysis/trial_record.hpp"

#include <algorithm>
#include <tuple>

#include "libstudy/analysis/task_choice.hpp"

namespace study {

namespace {

using study::TaskSession;
using study::TaskTrial;

stats::TrialTiming timing_of(const TaskShowing& shown) {
  if (!shown.verdict) return stats::TrialTiming::Unjudged;
  if (*shown.verdict == Verdict::Pass) return stats::TrialTiming::Pass;
  return *shown.verdict == Verdict::Degraded ? stats::TrialTiming::Degraded : stats::TrialTiming::Fail;
}

/// True if the pilot's predictor is known. Of an imported trial without frames it is the rate that the source
/// states, or the one that was asked for; a flag of the fit says so.
bool has_predictor(const TaskShowing& shown) {
  return shown.realised.frames > 0 || (!shown.framed && (shown.has_rates() || shown.nominal.mean > 0));
}

/// Excludes answered trials of a pilot without recorded frames. Their realised frame rate, the pilot's
/// predictor, is unknown.
void exclude_unrecorded(std::vector<stats::Exclusion>& list, const TaskSession& session,
                        const Question& question) {
  for (const TaskTrial& trial : session.trials) {
    const auto record = record_of(session, trial, question);
    if (trial.kind == "practice" || record.answers == 0 || has_predictor(trial.first) ||
        stats::is_excluded(list, session.participant, session.visit, trial.position))
      continue;
    list.push_back({session.participant, session.visit, trial.position, "timing",
                    "no frame of the showing is recorded", record.answers});
  }
}

}  // namespace

double answer_to(const TaskTrial& trial, const Question& question) {
  for (const TaskAnswer& answer : trial.answers) {
    if (answer.question != question.id || !answer.score) continue;
    if (!traits_of(question.kind).labelled) return *answer.score;
    return *answer.score == question.anchors.front().first ? 1 : 2;
  }
  return stats::TrialRecord::unanswered;
}

stats::TrialRecord record_of(const TaskSession& session, const TaskTrial& trial, const Question& question) {
  stats::TrialRecord out;
  out.participant = session.participant;
  out.visit = session.visit;
  out.position = trial.position;
  out.timing = timing_of(trial.first);
  out.timing_reason = trial.first.reason;
  if (trial.second && timing_of(*trial.second) > out.timing) {
    out.timing = timing_of(*trial.second);
    out.timing_reason = trial.second->reason;
  }
  out.interrupted = trial.excluded == interrupted_reason;
  if (trial.excluded && !out.interrupted)
    out.by_experimenter = trial.excluded->empty() ? "no reason given" : *trial.excluded;
  out.answer = answer_to(trial, question);
  out.answers = static_cast<int>(std::count_if(trial.answers.begin(), trial.answers.end(),
                                               [](const TaskAnswer& one) { return one.score.has_value(); }));
  // A repeat whose original is unknown gets its own position as original, so that no rule compares it with
  // another trial.
  if (trial.kind == "repeat") out.repeats = trial.repeats.value_or(trial.position);
  return out;
}

std::vector<stats::Exclusion> find_exclusions(const TaskProtocol& protocol, const Question& question,
                                              const stats::ExclusionRules& rules) {
  std::vector<stats::TrialRecord> trials;
  std::vector<stats::CatchRecord> catches;
  for (const TaskSession& session : protocol.sessions) {
    if (!has_answers(session)) continue;
    for (const TaskTrial& trial : session.trials) {
      if (trial.kind != "practice") trials.push_back(record_of(session, trial, question));
    }
    for (const CatchAnswer& page : session.catches) {
      if (page.score) catches.push_back({session.participant, session.visit, *page.score == page.expected});
    }
  }
  auto list = stats::find_exclusions(trials, catches, rules, protocol.pairs);
  if (!protocol.pilot()) return list;
  for (const TaskSession& session : protocol.sessions) exclude_unrecorded(list, session, question);
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
    return std::tie(a.participant, a.visit, a.position) < std::tie(b.participant, b.visit, b.position);
  });
  return list;
}

}  // namespace study
