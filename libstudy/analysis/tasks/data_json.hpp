#pragma once
/// The data that were analysed and that were not (docs/report.md: study, flow, exclusions, timing).

#include <map>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// "study" of one or two tasks; `database`: name for display.
Json study_json(const std::string& database, const std::vector<const TaskData*>& tasks);
/// Names of the exclusion rules that could exclude some of these data, whatever the answers; not those that
/// need something that was not shown or asked.
Json acting_rules_json(const TaskData& data, const stats::ExclusionRules& rules);
Json flow_json(const TaskFlow& flow);
/// "roster": every session of the database, by protocol. `sections`: the section that analyses a protocol, by
/// SHA-256.
Json roster_json(const TaskStudy& study, const std::multimap<std::string, std::string>& sections);
/// Lists.
Json exclusions_json(const TaskData& data);
Json timing_json(const TaskData& data);
/// One entry for each part in a list of timing_json(): its sums, and the number of cells in which every
/// showing passed.
Json timing_totals_json(const Json& timing);

}  // namespace study
