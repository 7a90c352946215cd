#pragma once
/// The tables [[hypothesis]] of an analysis plan.

#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/analysis/plan.hpp"
#include "stats/base/toml.hpp"

namespace study {

/// The value that an outcome has for one participant in one cell.
enum class OutcomeValue {
  Mean,        ///< mean of the scores
  Share,       ///< share of the answers that are one choice
  Comparison,  ///< pairs with a standard: share of the trials in which the comparison was chosen
  Threshold    ///< adaptive procedure: threshold of the participant's track
};
/// "mean", "share", "comparison", "threshold".
const char* outcome_word(OutcomeValue value);

/// The kind of value that the answers to the question have in this design. In pairs with a standard, a choice
/// with two anchors is a choice between the intervals: OutcomeValue::Comparison.
OutcomeValue value_of(const Design& design, const Question& question);

/// The score whose share is the outcome: the declared one, or the higher of two. None for
/// OutcomeValue::Mean and Threshold, and if a choice of several has no declared score.
std::optional<int> positive_score(const Question& question, std::optional<int> declared);

/// True if the two conditions of the hypothesis are seen by different people.
bool compares_groups(const Design& design, const stats::DeclaredHypothesis& hypothesis);

/// Indices into Design::cells of the cells that have these levels. Cells of the standard, with which pairs
/// compare the other cells, are left out.
std::vector<int> cells_with(const Design& design, const stats::DeclaredHypothesis::Levels& levels);

/// Reads those of the tables [[hypothesis]] that lack the key `task`; read_method_claims() reads the others.
/// `confidence`: default of the tables' key `confidence`. `protocol`: must have the factors, levels and
/// questions that the tables name; null: these names are not checked. base::Error at file:line:column.
std::vector<stats::DeclaredHypothesis> read_hypotheses(const std::vector<base::TomlTable>& tables,
                                                       double confidence, const Protocol* protocol);

/// The tables as text, which read_hypotheses() reads back.
std::string format_hypotheses(const std::vector<stats::DeclaredHypothesis>& hypotheses);

/// Name of the test for display; a paired t test of one condition is a "one-sample t test".
std::string test_title(const stats::DeclaredHypothesis& hypothesis);
/// "seen: stall, hitch h50 against hitch none, paired t test, two-sided": one hypothesis in one line.
std::string declared_text(const stats::DeclaredHypothesis& hypothesis);
/// The levels of a condition: "hitch h50, content dam"; "all cells" without levels.
std::string condition_text(const stats::DeclaredHypothesis::Levels& levels);

/// The hypothesis as JSON, as the plan declares it.
Json declared_json(const stats::DeclaredHypothesis& hypothesis);

}  // namespace study
