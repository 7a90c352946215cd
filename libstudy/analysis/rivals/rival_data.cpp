#include "libstudy/analysis/rivals/rival_data.hpp"

#include <algorithm>
#include <cmath>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/trial_record.hpp"
#include "libstudy/store/read/frame_times.hpp"
#include "stats/base/text.hpp"
#include "stats/ordinal/rival_comparison.hpp"

namespace study {

namespace {

bool is_ordinal(const Question& question) {
  const AnswerKindTraits& traits = traits_of(question.kind);
  return (traits.rated() || traits.yes_no) && static_cast<int>(scores_of(question).size()) <= most_scores;
}

int index_of_setting(std::vector<FpsSetting>& list, const FpsSetting& setting) {
  const auto found = std::find(list.begin(), list.end(), setting);
  if (found != list.end()) return static_cast<int>(found - list.begin());
  list.push_back(setting);
  return static_cast<int>(list.size()) - 1;
}

/// True for a trial whose answer is analysed: not practice, no repeat, answered and not excluded.
bool is_analysed(const TaskData& data, const TaskSession& session, const TaskTrial& trial) {
  if (trial.kind == "practice" || trial.kind == "repeat") return false;
  return !stats::is_excluded(data.exclusions, session.participant, session.visit, trial.position);
}

/// The score as its index on the scale; -1: unanswered.
int score_index(const TaskTrial& trial, const Question& question) {
  const auto scores = scores_of(question);
  for (const TaskAnswer& answer : trial.answers) {
    if (answer.question != question.id || !answer.score) continue;
    const auto found = std::find(scores.begin(), scores.end(), *answer.score);
    return found == scores.end() ? -1 : static_cast<int>(found - scores.begin());
  }
  return -1;
}

}  // namespace

stats::Result<ChosenTask> choose_rated_task(const TaskStudy& study, TaskSelection selection,
                                            std::string& mend) {
  selection.task = TaskKind::Pilot;
  auto chosen = choose_task(study, selection);
  if (!chosen && !choose_tasks(study, selection)) {
    auto own = selection;
    own.task = TaskKind::Own;
    if (choose_tasks(study, own)) {
      selection = own;
      chosen = choose_task(study, selection);
    }
  }
  if (!chosen) {
    mend = mend_of_choice(study, selection);
    return chosen;
  }
  if (chosen->protocol.pairs) {
    mend = "choose a protocol whose trials show one stimulus each";
    return stats::Refusal{"a trial of " + hashed_name(chosen->protocol) + " shows two stimuli"};
  }
  if (!is_ordinal(chosen->question)) {
    std::vector<std::string> ordinal;
    for (const Question& one : chosen->protocol.questions)
      if (is_ordinal(one)) ordinal.push_back(one.id);
    mend = ordinal.empty() ? "ask a rating on a scale of at most " + std::to_string(most_scores) + " scores"
                           : "choose one with --question: " + base::joined(ordinal);
    return stats::Refusal{"question '" + chosen->question.id + "' is neither a rating with at most " +
                          std::to_string(most_scores) + " scores nor yes or no"};
  }
  return chosen;
}

RivalData collect_rival_data(const StudyFile& file, const TaskStudy& study, const ChosenTask& chosen,
                             const stats::ExclusionRules& rules) {
  RivalData out;
  out.task = collect_task(study, chosen, rules);
  out.answers.choices = static_cast<int>(scores_of(chosen.question).size());
  const auto times = read_frame_times(file, chosen.protocol.sha256);
  for (const TaskSession& session : out.task.protocol.sessions) {
    for (const TaskTrial& trial : session.trials) {
      const int score = score_index(trial, chosen.question);
      if (score < 0 || !is_analysed(out.task, session, trial)) continue;
      const auto found = times.find({session.uid, trial.position});
      if (found == times.end() || !found->second.why_not.empty()) {
        ++out.without_frames[found == times.end() ? "no frame is recorded" : found->second.why_not];
        continue;
      }
      out.answers.score.push_back(score);
      out.answers.person.push_back(place_in(out.participants, session.participant));
      if (out.answers.person.back() == static_cast<int>(out.participants.size()))
        out.participants.push_back(session.participant);
      out.setting.push_back(index_of_setting(out.settings, trial.first.nominal));
      out.timing.push_back(timing_predictors(found->second.intervals_s, found->second.animation_error_ms));
    }
  }
  out.answers.people = static_cast<int>(out.participants.size());
  return out;
}

std::string why_no_comparison(const RivalData& data, std::string& mend) {
  if (data.answers.n() == 0) {
    if (data.without_frames.empty()) {
      const auto reason = nothing_counts(data.task);
      mend = data.task.exclusions.empty() ? "collect answers"
                                          : "collect answers, or choose another --exclude or --plan";
      return reason.empty() ? "no trial has an answer to '" + data.task.question.id + "'" : reason;
    }
    mend = "the models need the times of all frames, which a session records; take a database that has them";
    const int simulated = data.task.flow.simulated_left_out;
    return "no analysed answer has frame times: " + data.without_frames.begin()->first +
           (simulated > 0 ? "; " + std::to_string(simulated) +
                                " sessions of simulated observers are left out, as there are people"
                          : "");
  }
  if (data.settings.size() < 2) {
    mend = "compare models on trials of several timings";
    return "all answers are about one timing, " + setting_name(data.settings.front());
  }
  const auto& scores = data.answers.score;
  if (std::all_of(scores.begin(), scores.end(), [&](int score) { return score == scores.front(); })) {
    mend = "compare models on answers that differ; vip-stats report describes these";
    return "all " + std::to_string(scores.size()) + " answers are " +
           std::to_string(scores_of(data.task.question)[static_cast<std::size_t>(scores.front())]) +
           ", so there is no difference that a model could predict";
  }
  if (data.answers.people < stats::least_people_to_compare) {
    mend = "collect more participants";
    return "models are compared over at least " + std::to_string(stats::least_people_to_compare) +
           " people, not " + std::to_string(data.answers.people);
  }
  return "";
}

std::string why_not_recorded(const RivalData& data, const std::vector<TimingModel>& models,
                             std::string& mend) {
  constexpr auto error = TimingPredictor::AnimationError;
  const auto lacking = std::count_if(data.timing.begin(), data.timing.end(), [](const auto& one) {
    return std::isnan(one[static_cast<std::size_t>(error)]);
  });
  const bool used =
      std::any_of(models.begin(), models.end(), [](const TimingModel& one) { return one.uses(error); });
  if (lacking == 0 || !used) return "";
  mend = std::string("leave ") + predictor_name(error) + " out of --models";
  return std::string(predictor_name(error)) + " is not recorded for " + std::to_string(lacking) + " of " +
         std::to_string(data.timing.size()) +
         " answers: their content followed frames instead of time, or they are imported or of a version "
         "before 8 of the schema";
}

}  // namespace study
