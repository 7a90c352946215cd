#pragma once
/// The results of a study with factors (format 3) as one JSON document (docs/report.md).

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

struct FactorStudyRequest {
  std::filesystem::path database;  ///< used only for its name, for display
  PlanInForce plan;
  /// The preregistration whose plan is in force. If empty, the hypotheses count as declared, but not as
  /// preregistered.
  std::optional<FrozenFacts> frozen = {};
  /// An earlier document of the same protocol, against which participants are marked as new.
  std::optional<Json> since = {};
  std::string since_file = {};  ///< file name of `since` for display
};

/// The protocol with factors that `by` denotes (is_meant(); empty: any). Protocols without real answers are
/// ignored if another such protocol has real answers. base::Error if there is none, or more than one.
const TaskProtocol& factor_protocol(const TaskStudy& study, const std::string& by,
                                    const std::string& database);

/// The document of schema vip-study/1. base::Error if `since` has another schema or is about another
/// protocol.
Json factor_study_json(const TaskStudy& study, const TaskProtocol& protocol,
                       const FactorStudyRequest& request);

/// The tables of the document: name of the CSV file without ".csv", and its lines.
std::vector<std::pair<std::string, Json>> factor_study_tables(const Json& document);

}  // namespace study
