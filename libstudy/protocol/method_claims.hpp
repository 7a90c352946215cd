#pragma once
/// Hypotheses about methods, which Task 1 and Task 2 test: the tables [[hypothesis]] of a plan file with the
/// key `task`. The paper's hypotheses ship with the programs (protocols/plans/paper.toml).

#include <string>
#include <vector>

#include "stats/analysis/plan.hpp"
#include "stats/base/toml.hpp"

namespace study {

using MethodClaims = std::vector<stats::MethodClaim>;

/// Reads the tables that have the key `task`; skips the other tables. base::Error at file:line:column for a
/// wrong value, or for an id that another table has.
MethodClaims read_method_claims(const std::vector<base::TomlTable>& tables);

/// The margins that a test of this score ("realism" or "sickness") may have: below the range of its scale,
/// because every difference lies within a wider margin.
base::Range margin_range(const std::string& score);

/// The claims as tables [[hypothesis]], which read_method_claims() reads back.
std::string format_method_claims(const MethodClaims& claims);

/// The claims (hypotheses about methods) of protocols/plans/paper.toml, which is read at the first call.
/// base::Error if the file is missing or malformed.
const MethodClaims& shipped_claims();
/// The plan's own claims, or shipped_claims() if the plan lists none.
const MethodClaims& claims_in_force(const stats::AnalysisPlan& plan);

/// The claims of one task (1 or 2).
MethodClaims claims_of_task(const MethodClaims& claims, int task);

/// "H1 to H4" for three or more ids that are numbered in order, else "A, B and C"; empty without ids.
std::string ids_in_short(const std::vector<std::string>& ids);
std::vector<std::string> ids_of(const MethodClaims& claims);
/// The ids of the claims for which `flag` is true: "A, B and C".
std::string ids_with(const MethodClaims& claims, bool stats::MethodClaim::*flag);

/// The name of the statistical test in plan files: "paired_t", "tost" or "binomial".
const char* claim_test_word(stats::HypothesisKind kind);

}  // namespace study
