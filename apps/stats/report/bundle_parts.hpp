#pragma once
/// What freezing and comparing a preregistration share.

#include <cstddef>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/base/json.hpp"

namespace apps::report {

/// Bytes that a file of a bundle may have.
inline constexpr std::size_t largest_bundle_file = 1 << 24;

/// What preregistration fixes of a hypothesis: no estimate, no p. Takes "hypotheses" of the results just as
/// well as hypothesis_json(), so that both sides of a comparison pass through here.
base::Json fixed_part(const base::Json& hypothesis);

/// plan.toml of a bundle: a rule that cannot act on what these protocols show and ask is a comment which says
/// why.
std::string frozen_plan(const std::vector<study::Protocol>& protocols, const stats::AnalysisPlan& plan);

/// For people, to be deposited with the hash. `untested`: "H1 of task1: the protocol does not show FovFluid".
std::string bundle_text(const std::vector<study::Protocol>& protocols, const stats::AnalysisPlan& plan,
                        const base::Json& hypotheses, const std::vector<std::string>& untested,
                        bool with_power, const std::string& frozen_utc);

/// Whether the bundle is older than the first answer of a part, by the clocks of both, or by the order of
/// rows where these disagree: an entry of "times". `used`: of the results' study.protocols.
base::Json time_json(const std::string& frozen_utc, const base::Json& used);

}  // namespace apps::report
