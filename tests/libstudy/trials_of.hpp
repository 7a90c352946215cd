#pragma once
/// All planned trials of a study in one list, read from the database by read_tasks(), the reader of the
/// analyses.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/read/task_answers.hpp"

namespace study::test {

/// A trial with its session's participant and observer.
struct TrialOf {
  std::string participant, observer;
  TaskTrial trial;

  /// Score of the answer to the trial's first question.
  std::optional<int> score() const { return trial.answers.at(0).score; }
};

/// All planned trials, shown or not, in the order of read_tasks().
inline std::vector<TrialOf> trials_of(const std::filesystem::path& database) {
  std::vector<TrialOf> out;
  for (const TaskProtocol& protocol : read_tasks(database).protocols) {
    for (const TaskSession& session : protocol.sessions) {
      for (const TaskTrial& trial : session.trials)
        out.push_back({session.participant, session.observer, trial});
    }
  }
  return out;
}

}  // namespace study::test
