#pragma once
/// The answers of a study with the real timing of each trial, as the comparison of timing models takes them.

#include <map>
#include <string>
#include <vector>

#include "libstudy/analysis/task_data.hpp"
#include "libstudy/analysis/timing_predictors.hpp"
#include "libstudy/store/study_file.hpp"
#include "stats/ordinal/rival_fit.hpp"

namespace study {

/// Analysed answers to one question. `answers`, `setting` and `timing` have one element for each answer.
struct RivalData {
  TaskData task;                          ///< protocol, question, exclusions, and who was left out
  std::vector<std::string> participants;  ///< codes; RivalAnswers::person refers to them
  stats::RivalAnswers answers;
  std::vector<int> setting;              ///< index into `settings`
  std::vector<TimingPredictors> timing;  ///< of the real frame times
  std::vector<FpsSetting> settings;      ///< the timings asked for that occur, each once
  std::map<std::string, int>
      without_frames;  ///< answers left out, by the reason why they have no frame times
};

/// The protocol and the question that match: of a pilot, or else of another design with single stimuli.
/// Refused with the reason if none or several match, and if the question is neither a rating with at most
/// most_scores scores nor yes or no. `mend` then receives the advice.
stats::Result<ChosenTask> choose_rated_task(const TaskStudy& study, TaskSelection selection,
                                            std::string& mend);
inline constexpr int most_scores = 21;

/// Collects the answers as collect_task() does (practice, repeats, excluded trials and sessions are left out)
/// and computes the predictors from the recorded frames. base::Error as read_frame_times().
RivalData collect_rival_data(const StudyFile& file, const TaskStudy& study, const ChosenTask& chosen,
                             const stats::ExclusionRules& rules);

/// Why the models cannot be compared on these data: no answer, no frames, one setting, equal
/// answers, or too few people.
/// Empty if they can. `mend` then receives the advice.
std::string why_no_comparison(const RivalData& data, std::string& mend);

/// Why these models cannot be compared: a predictor is not recorded for some answers. Empty if they can.
/// `mend` then receives the advice.
std::string why_not_recorded(const RivalData& data, const std::vector<TimingModel>& models,
                             std::string& mend);

}  // namespace study
