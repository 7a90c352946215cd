#pragma once
/// A study's results as one JSON document (docs/report.md).

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/task_data.hpp"
#include "libstudy/sweep/setting_price.hpp"

namespace study {

struct ResultsRequest {
  std::filesystem::path database;
  std::vector<TaskKind> tasks;  ///< kinds of analysis to make; a kind for which the database has no protocol
                                ///< is listed in Results::missing
  std::string protocol;         ///< text for is_meant(); empty: all protocols
  PlanInForce plan;
  std::shared_ptr<const SweepTables> sweep = {};  ///< tables of an accuracy sweep; null: none
  std::string sweep_file = {};                    ///< the sweep file's name for display
  /// True: makes the results although the journal of answers has answers that the database lacks.
  bool incomplete = false;
  std::string question = {};  ///< the question's id; empty: all main questions
  /// Score at which a pilot's curve is fitted; empty: the plan's, else the protocol's, else the middle of the
  /// scale.
  std::optional<double> level = {};
};

/// A requested analysis without results.
struct MissingTask {
  TaskKind task = TaskKind::Task1;
  std::string reason;
  std::string mend;  ///< advice for the user
};

struct Results {
  /// The document. Its own entries hold the first analysis of each task. Analyses of further protocols or
  /// questions of a task are in the list "apart", each as a document of the same form.
  Json json;
  std::vector<MissingTask> missing;
};

/// Makes the results of a study that was already read. `request.database` is used only for its name.
Results make_results(const TaskStudy& study, const ResultsRequest& request);
/// Reads the database and makes its results. base::Error if the database cannot be read, or if it lacks
/// answers of its journal and `incomplete` is false.
Results study_results(const ResultsRequest& request);

}  // namespace study
