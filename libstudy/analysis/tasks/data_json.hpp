#pragma once
/// Describes the analysed and the excluded data (docs/report.md: study, flow, roster, exclusions, timing).

#include <map>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/task_data.hpp"

namespace study {

/// The entry "study" for the given tasks. `database`: the database's name for display.
Json study_json(const std::string& database, const std::vector<const TaskData*>& tasks,
                const stats::AnalysisPlan& plan);
/// Names of the exclusion rules that data of this study can violate. A rule is missing if the data lack what
/// it checks (timing verdicts, catch pages, repeated trials, enough trials), if it is for pairs and the study
/// shows no pairs (or the reverse), or if its limit on differences of ratings is not below the scale's range.
Json acting_rules_json(const TaskData& data, const stats::ExclusionRules& rules);
Json flow_json(const TaskFlow& flow);
/// The entry "roster": counts of all participants and sessions of the database, by protocol. `sections`: for
/// the SHA-256 of a protocol, the sections of the report that analyse the protocol.
Json roster_json(const TaskStudy& study, const std::multimap<std::string, std::string>& sections);
/// A list with one entry for each exclusion.
Json exclusions_json(const TaskData& data);
/// A list with one entry for each scene, n_*, method and frame rate: the timing of its showings.
Json timing_json(const TaskData& data);
/// A list with one entry for each cell of a protocol with factors that was shown: the cell's nominal timing
/// and the timing measured in its showings.
Json timing_by_cell_json(const TaskData& data);
/// Sums of the lists of timing_json(), one entry for each task. "flawed_cells" counts the cells in which the
/// timing of a showing was degraded or failed.
Json timing_totals_json(const Json& timing);

}  // namespace study
