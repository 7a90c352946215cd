#pragma once
/// Scales of quality as one JSON document of schema vip-scale/1 (docs/report.md).

#include <string>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/tasks/scale_table.hpp"
#include "stats/preference/quality_scale.hpp"

namespace study {

struct ScaleRequest {
  std::string place;   ///< the input's path, for messages
  std::string source;  ///< its name, for the document
  stats::ScaleOptions options;
  int next = 0;  ///< number of pairs to propose for each scale
};

/// Names of priors, in JSON and in the option --prior: "none", "normal", "bounded".
const char* prior_name(stats::ScalePrior prior);

/// Fits each group's scale. base::Error, with what to do, if a group has no scale.
Json scale_json(const ScaleTable& table, const ScaleRequest& request);

}  // namespace study
