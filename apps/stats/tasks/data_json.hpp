#pragma once
/// What was analysed and what was not (docs/results.md: study, flow, exclusions, timing).

#include <map>
#include <string>
#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "apps/stats/data/task_data.hpp"

namespace apps {

/// "study" of one or two tasks; `database`: name to show.
Json study_json(const std::string& database, const std::vector<const TaskData*>& tasks);
/// Names of the rules of exclusion that could leave out something of these data, whatever they say; those
/// that compare with what was not shown or asked are none.
Json acting_rules_json(const TaskData& data, const stats::ExclusionRules& rules);
Json flow_json(const TaskFlow& flow);
/// "roster": every session of the database, by protocol. `sections`: where a protocol is analysed, by
/// SHA-256.
Json roster_json(const study::TaskStudy& study, const std::multimap<std::string, std::string>& sections);
/// Lists.
Json exclusions_json(const TaskData& data);
Json timing_json(const TaskData& data);
/// One entry for each part in a list of timing_json(): its sums, and in how many cells every showing passed.
Json timing_totals_json(const Json& timing);

}  // namespace apps
