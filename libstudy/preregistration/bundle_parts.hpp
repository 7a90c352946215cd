#pragma once
/// Functions used both to write a preregistration and to compare it with a study.

#include <cstddef>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/hypotheses.hpp"
#include "stats/base/json.hpp"

namespace study::report {

/// Largest size of a file of a bundle, in bytes.
inline constexpr std::size_t largest_bundle_file = 1 << 24;

/// The fields of a hypothesis that preregistration fixes, thus without estimates and p values. `hypothesis`:
/// output of hypothesis_json() when a bundle is written, an entry of "hypotheses" of the results when a study
/// is compared with a bundle.
base::Json fixed_part(const base::Json& hypothesis);

/// Text of a bundle's plan.toml, with the hypotheses in force if one of the protocols tests any. A key that
/// has no effect in any of the protocols is written as a TOML comment with the reason.
std::string frozen_plan(const std::vector<Protocol>& protocols, stats::AnalysisPlan plan);

/// Text of a bundle's PREREGISTRATION.txt. `untested`: as returned by untested_claims(). `with_power`: true
/// if the bundle holds power.json.
std::string bundle_text(const std::vector<Protocol>& protocols, const stats::AnalysisPlan& plan,
                        const base::Json& hypotheses, const std::vector<std::string>& untested,
                        bool with_power, const std::string& frozen_utc);

/// An entry of the list "times" of a comparison: "frozen_before" is true if the bundle is older than the
/// first answer to a protocol, false if it is not, and null if this is unknown. The times of answers decide.
/// If such a time is impossible (before ViP-Lab existed), the times of the database's rows before the answer
/// count too. `used`: the protocol's entry in study.protocols of the results.
base::Json time_json(const std::string& frozen_utc, const base::Json& used);

}  // namespace study::report
