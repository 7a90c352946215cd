#pragma once
/// "sickness" of the results: SSQ before and after, FMS over the session.

#include <vector>

#include "apps/stats/data/json_parts.hpp"
#include "libstudy/store/sickness.hpp"
#include "stats/analysis/plan.hpp"

namespace apps {

/// One entry for each protocol that asked for either. Test data step back behind real ones, within a protocol
/// observer models behind people; no other rule leaves out anything, since all of it tells of safety.
Json sickness_json(std::vector<study::SicknessSession> sessions, const stats::AnalysisPlan& plan);

}  // namespace apps
