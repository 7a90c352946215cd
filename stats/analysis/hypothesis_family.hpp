#pragma once
/// From the tests of one hypothesis to its verdict.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/hypotheses.hpp"

namespace stats {

inline constexpr const char* ours = "Ours";
inline constexpr const char* ours_tsp = "Ours-TSp";
inline constexpr const char* fov_fluid = "FovFluid";
inline constexpr const char* hi_res = "HiRes";

struct FamilyTest {
  HypothesisTest test;
  /// The estimate lies in the direction claimed; true for tests that have a direction built in.
  bool right = true;
};

struct Family {
  const AnalysisPlan& plan;
  std::string untestable;  ///< why the hypothesis cannot be tested; empty: it can
  Hypothesis out;          ///< id, title, rules are filled in
  std::vector<FamilyTest> tests;
};

/// A family that stands empty, with what the plan says of it.
Family begin_family(const char* id, HypothesisKind kind, const AnalysisPlan& plan,
                    const std::string& untestable);

/// A rule in words, "paired t tests, two-sided, all significant and in the direction of better": the test as
/// it is with one side or with two, and the side that a two-sided one must fall on (empty: it has none).
struct RuleWords {
  std::string one_sided, two_sided, claim;
};
std::string rule_text(const Hypothesis& hypothesis, const RuleWords& words, std::size_t tests);

/// Holm over the family as planned (a test without p counts as 1), decisions and sentences.
Hypothesis finish(Family family);

/// Holm over those pairs that `chosen` names; empty for the others and for refused tests.
std::vector<std::optional<double>> holm_over_pairs(
    std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
    const std::function<bool(const std::string&, const std::string&)>& chosen);

}  // namespace stats
