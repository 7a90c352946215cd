#pragma once
/// The trials of a study as the analyses see them, for tests that look for one.

#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/task_answers.hpp"

namespace study::test {

/// Of a session.
struct TrialOf {
  std::string participant, observer;
  TaskTrial trial;

  /// To its first question.
  std::optional<int> score() const { return trial.answers.at(0).score; }
};

/// Every planned trial, shown or not, in the order of read_tasks().
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
