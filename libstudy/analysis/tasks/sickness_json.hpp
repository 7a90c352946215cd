#pragma once
/// The entry "sickness" of the results: SSQ before and after the session, and FMS during the session.

#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/store/read/sickness.hpp"
#include "stats/analysis/plan.hpp"

namespace study {

/// One entry for each protocol that asked for SSQ or FMS. Test data are left out if real data exist. Observer
/// models are left out if the protocol has sessions of people. No other rule excludes data, since every
/// answer matters for safety. `sessions`: sorted by protocol.
Json sickness_json(std::vector<SicknessSession> sessions, const stats::AnalysisPlan& plan);

}  // namespace study
