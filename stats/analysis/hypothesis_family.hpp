#pragma once
/// From the tests of one hypothesis to its verdict.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/hypotheses.hpp"

namespace stats {

struct FamilyTest {
  HypothesisTest test;
  bool right =
      true;  ///< the estimate lies in the direction claimed; true for tests that have a direction built in
};

struct Family {
  const AnalysisPlan& plan;
  std::string untestable;  ///< why the hypothesis cannot be tested; empty: it can
  Hypothesis out;          ///< id, title, rules are filled in
  std::vector<FamilyTest> tests;
};

/// Holm over the family as planned (a test without p counts as 1), decisions and sentences.
Hypothesis finish(Family family);

/// Holm over those pairs that `chosen` names; empty for the others and for refused tests.
std::vector<std::optional<double>> holm_over_pairs(
    std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
    const std::function<bool(const std::string&, const std::string&)>& chosen);

}  // namespace stats
