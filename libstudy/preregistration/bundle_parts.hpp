#pragma once
/// Functions shared by freezing and comparing a preregistration.

#include <cstddef>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/base/json.hpp"

namespace study::report {

/// Largest size of a file of a bundle, in bytes.
inline constexpr std::size_t largest_bundle_file = 1 << 24;

/// The part of a hypothesis that preregistration fixes: no estimate, no p. Takes an entry of "hypotheses" of
/// the results as well as the output of hypothesis_json(), so that both sides of a comparison use it.
base::Json fixed_part(const base::Json& hypothesis);

/// plan.toml of a bundle. A rule that cannot act on anything these protocols show and ask is written as a
/// comment that says why.
std::string frozen_plan(const std::vector<Protocol>& protocols, const stats::AnalysisPlan& plan);

/// The readable text, to be deposited with the hash. `untested`: "H1 of task1: the protocol does not show
/// FovFluid".
std::string bundle_text(const std::vector<Protocol>& protocols, const stats::AnalysisPlan& plan,
                        const base::Json& hypotheses, const std::vector<std::string>& untested,
                        bool with_power, const std::string& frozen_utc);

/// An entry of "times": tells if the bundle is older than the first answer of a part, by both clocks, or by
/// the order of rows if these disagree. `used`: the part's entry of the results' study.protocols.
base::Json time_json(const std::string& frozen_utc, const base::Json& used);

}  // namespace study::report
