#pragma once
/// "sickness" of the results: SSQ before and after, FMS over the session.

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/store/read/sickness.hpp"
#include "stats/analysis/plan.hpp"

namespace study {

/// One entry for each protocol that asked for either. Test data are left out if real data exist, and within a
/// protocol observer models if people exist. No other rule excludes anything, since all of these data concern
/// safety.
Json sickness_json(std::vector<SicknessSession> sessions, const stats::AnalysisPlan& plan);

}  // namespace study
