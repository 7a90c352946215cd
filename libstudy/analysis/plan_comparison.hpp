#pragma once
/// The table [model_comparison] of an analysis plan: a comparison of models of frame timing that is declared
/// before the data are seen (vip-stats compare-models).

#include <string>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/base/toml.hpp"

namespace study {

/// Reads the table. file: the plan, for messages. `protocol`: must show one stimulus in a trial and rate it
/// by the question; null: this is not checked. base::Error at file:line:column.
stats::DeclaredComparison read_comparison(const base::TomlTable& table, const std::string& file,
                                          const Protocol* protocol);

/// The table as text, which read_comparison() reads back.
std::string format_comparison(const stats::DeclaredComparison& comparison);
/// "ptpe, longest and p95 of the ratings of 'satisfaction'; expected: longest": the comparison in one line.
std::string comparison_text(const stats::DeclaredComparison& comparison);
Json comparison_json(const stats::DeclaredComparison& comparison);

}  // namespace study
