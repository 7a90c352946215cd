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
  std::vector<TaskKind> tasks;  ///< tasks without a protocol in the database are left out
  std::string protocol;         ///< name, with or without version, or leading digits of a SHA-256; empty: all
  PlanInForce plan;
  std::shared_ptr<const SweepTables> sweep = {};  ///< null if not requested
  std::string sweep_file = {};                    ///< its name for display
  bool incomplete = false;                        ///< continue if the journal holds more than the database
  std::string question = {};                      ///< its id; empty: all
  std::optional<double> level = {};               ///< of a pilot's curve; empty: see level_of()
};

/// A task of the request that has no results.
struct MissingTask {
  TaskKind task = TaskKind::Task1;
  std::string reason;
  std::string mend;  ///< advice for the user
};

struct Results {
  /// The first analysis of each task. Further analyses, of another protocol of a task or another question,
  /// are in "apart": a list of documents of the same form, each with one analysis.
  Json json;
  std::vector<MissingTask> missing;
};

/// Results of a study that was already read; the request's database only gives its name.
Results make_results(const TaskStudy& study, const ResultsRequest& request);
/// Reads the database; base::Error if that fails.
Results study_results(const ResultsRequest& request);

}  // namespace study
