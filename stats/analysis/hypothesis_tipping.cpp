/// Tipping points of the tests of H1 to H3.

#include <algorithm>
#include <limits>

#include "stats/analysis/hypotheses.hpp"
#include "stats/inference/adjust.hpp"
#include "stats/inference/distributions.hpp"

namespace stats {

namespace {

/// The level below which a test's uncorrected p holds, given the other tests: alpha, or under Holm alpha
/// divided by the number of tests that Holm does not reject without this one.
double level_of(const Hypothesis& hypothesis, std::size_t index) {
  if (hypothesis.decision != DecisionRule::Holm) return hypothesis.alpha;
  std::vector<double> p;
  for (const HypothesisTest& test : hypothesis.tests) p.push_back(test.p.value_or(1));
  p[index] = 1;
  const auto holm = adjust(p, Adjustment::Holm, p.size());
  const auto rejected =
      std::count_if(holm->p.begin(), holm->p.end(), [&](double one) { return one < hypothesis.alpha; });
  return hypothesis.alpha / static_cast<double>(static_cast<std::ptrdiff_t>(p.size()) - rejected);
}

/// Range of estimates for which the test holds, with its error unchanged.
DecisionRange range_of(const Hypothesis& hypothesis, const HypothesisTest& test, double level,
                       bool higher_is_better) {
  constexpr double open = std::numeric_limits<double>::infinity();
  const double reach =
      student_upper_quantile(hypothesis.one_sided ? level : 0.5 * level, *test.df) * *test.se;
  const double margin = test.margin.value_or(0);
  if (hypothesis.kind == HypothesisKind::Equivalence) return {reach - margin, margin - reach};
  return higher_is_better ? DecisionRange{reach - margin, open} : DecisionRange{-open, margin - reach};
}

Result<TippingPoint> tipping_of(const Hypothesis& hypothesis, std::size_t index, const ScoreTable& table) {
  const HypothesisTest& test = hypothesis.tests[index];
  if (!test.p) return Refusal{test.reason};
  const int n_star = table.n_star_index(test.n_star);
  const int a = table.method_index(test.a), b = table.method_index(test.b);
  if (!test.t) return no_tipping_point(table, n_star, a, b, test.holds);
  const auto range = range_of(hypothesis, test, level_of(hypothesis, index), table.scale().higher_is_better);
  return tipping_point(table, n_star, a, b, *test.estimate, range);
}

}  // namespace

void add_tipping_points(std::span<Hypothesis> hypotheses, std::span<const ScoreTable> tables) {
  for (Hypothesis& hypothesis : hypotheses) {
    for (std::size_t i = 0; i < hypothesis.tests.size(); ++i) {
      const auto table = std::find_if(tables.begin(), tables.end(), [&](const ScoreTable& one) {
        return one.scale().code == hypothesis.tests[i].score;
      });
      if (table != tables.end()) hypothesis.tests[i].tipping = tipping_of(hypothesis, i, *table);
    }
  }
}

}  // namespace stats
