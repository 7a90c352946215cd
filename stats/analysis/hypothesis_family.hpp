#pragma once
/// Combines the tests of one hypothesis into its verdict.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/hypotheses.hpp"

namespace stats {

struct FamilyTest {
  HypothesisTest test;
  /// True if the estimate lies in the claimed direction. Always true in Task 1 (ratings) for equivalence,
  /// which has no direction, and for one-sided tests, whose p includes the direction.
  bool right = true;
};

struct Family {
  const MethodClaim& claim;
  const AnalysisPlan& plan;
  std::string untestable;  ///< why the hypothesis cannot be tested; empty if it can
  Hypothesis out;          ///< begin_family() sets the claim's texts and the plan's settings, the caller sets
                           ///< `rule`, finish() sets all other fields
  std::vector<FamilyTest> tests;
};

/// A family without tests, with the claim's texts and the plan's settings. `untestable`: why claims that need
/// gaze cannot be tested.
Family begin_family(const MethodClaim& claim, const AnalysisPlan& plan, const std::string& untestable);

/// True if the procedure of the claim's paper counts a test as confirmed; false without a paper.
/// `significant`: the uncorrected p is below alpha. `right`: the estimate favours the first of the two
/// methods.
bool confirmed_as_in_paper(const MethodClaim& claim, bool significant, bool right);

/// Parts of a decision rule in words, as in "paired t tests, two-sided, all significant and in the direction
/// of better": the name of a one-sided and of a two-sided test, and the side on which a two-sided result must
/// lie (empty: no side).
struct RuleWords {
  std::string one_sided, two_sided, claim;
};
std::string rule_text(const Hypothesis& hypothesis, const RuleWords& words, std::size_t tests);

/// Corrects by Holm over the planned family (a test without p counts as 1), then sets the verdict and its
/// texts.
Hypothesis finish(Family family);

/// p of each pair after Holm over the pairs for which `chosen` is true; empty for other pairs and for refused
/// tests.
std::vector<std::optional<double>> holm_over_pairs(
    std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
    const std::function<bool(const std::string&, const std::string&)>& chosen);

}  // namespace stats
