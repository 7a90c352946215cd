#include "stats/analysis/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "stats/analysis/hypothesis_family.hpp"
#include "stats/analysis/mixed_scores.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/inference/adjust.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/inference/unanimous.hpp"

namespace stats {

namespace {

// Each test of Task 1 (ratings) compares two methods at one size n_* of the water (nominal number of
// particles), by a paired t test (an exact sign test if all differences are equal) or by the mixed model.

/// Difference of two methods' mean scores, a - b, with its standard error.
struct ScoreDifference {
  double estimate = 0, se = 0, df = 0;
  double t(double null = 0) const { return (estimate - null) / se; }
  double p(Alternative side, double null = 0) const;
};

/// One test of Task 1 (ratings) before its p is computed.
struct ScoreContrast {
  HypothesisTest test;  ///< label, methods and n; its reason says why `difference` could not be computed
  std::optional<ScoreDifference> difference;
  std::optional<Unanimous> unanimous;  ///< set if all paired differences are equal, for the exact sign test
  bool higher_is_better = true;
  double margin = 0;
};

/// Computes the difference by a paired t test, without the intervals of effect sizes: they would take most of
/// the time, and power simulations call this function often.
void take_pairs(ScoreContrast& contrast, const ScoreTable& table, int n_star, int a, int b) {
  HypothesisTest& test = contrast.test;
  const auto pairs = complete_pairs(table.column(n_star, a), table.column(n_star, b));
  test.n = pairs.x.size();
  if (const auto exact = exact_differences(table.means(n_star, a), table.means(n_star, b)))
    contrast.unanimous = unanimous(*exact);
  const auto paired = t_test_paired(pairs.x, pairs.y, {.effect_intervals = false});
  test.reason = paired.reason();
  if (!paired) return;
  contrast.difference = {paired->estimate, paired->stderr_estimate, paired->df};
  test.d_z = paired->t / std::sqrt(static_cast<double>(test.n));
  test.paper_p = contrast.difference->p(Alternative::TwoSided);
}

void take_model(ScoreContrast& contrast, const Result<MixedScores>& model, int n_star, int a, int b) {
  if (!model) {
    contrast.test.reason = "no mixed model: " + model.reason();
    return;
  }
  contrast.test.n = static_cast<std::size_t>(model->fit.participants);
  const auto difference = model->difference(n_star, a, b, 0.95);
  contrast.test.reason = difference.reason();
  if (difference) contrast.difference = {difference->estimate, difference->se, difference->df};
}

/// The exact sign test with the p-value `p`, for differences that are all equal and so have no t. `right`:
/// the estimate lies in the claimed direction.
FamilyTest sign_test(const ScoreContrast& contrast, double p, bool right = true) {
  FamilyTest out{contrast.test, right};
  out.test.method = "exact sign test";
  out.test.reason.clear();
  out.test.estimate = contrast.unanimous->value;
  out.test.p = p;
  return out;
}

bool is_better(const ScoreContrast& contrast, double difference) {
  return contrast.higher_is_better ? difference > 0 : difference < 0;
}

Alternative better_side(const ScoreContrast& contrast) {
  return contrast.higher_is_better ? Alternative::Greater : Alternative::Less;
}

/// The level of each one-sided test: alpha for a one-sided hypothesis, half of alpha for a two-sided one.
double level_of(const Family& family) {
  return family.out.one_sided ? family.plan.alpha : 0.5 * family.plan.alpha;
}

void set_interval(ScoreContrast& contrast, double confidence) {
  const ScoreDifference& d = *contrast.difference;
  const double half = student_upper_quantile(0.5 - 0.5 * confidence, d.df) * d.se;
  contrast.test.ci = {d.estimate - half, d.estimate + half};
  contrast.test.ci_confidence = confidence;
}

/// Sets paper_holds from the uncorrected two-sided p of the paired test, as the claim's paper does; false in
/// the mixed model, which has no such p.
void set_paper(ScoreContrast& contrast, const Family& family) {
  HypothesisTest& test = contrast.test;
  test.paper_holds =
      test.paper_p && confirmed_as_in_paper(family.claim, *test.paper_p < family.plan.alpha,
                                            is_better(contrast, contrast.difference->estimate));
}

double ScoreDifference::p(Alternative side, double null) const { return student_p(t(null), df, side); }

/// The contrast of methods a and b at one n_* (nominal number of particles), with the claim's margin for this
/// score or, if it has none, the table's. `model` is the mixed model of all answers of the table; null for a
/// paired test.
ScoreContrast score_contrast(const MethodClaim& claim, const ScoreTable& table,
                             const Result<MixedScores>* model, int n_star, const std::string& a,
                             const std::string& b) {
  const std::string& block = table.n_stars()[static_cast<std::size_t>(n_star)];
  ScoreContrast out;
  out.higher_is_better = table.scale().higher_is_better;
  const auto own = claim.margins.find(table.scale().code);
  out.margin = own == claim.margins.end() ? table.scale().margin : own->second;
  out.test.method = model ? "t test of the mixed model" : "paired t test";
  out.test.label = a + " - " + b + ", " + table.scale().code + ", " + block;
  out.test.score = table.scale().code;
  out.test.n_star = block;
  out.test.a = a;
  out.test.b = b;
  const int first = table.method_index(a), second = table.method_index(b);
  if (first < 0 || second < 0) {
    out.test.reason = "the study does not show " + (first < 0 ? a : b);
    return out;
  }
  if (model)
    take_model(out, *model, n_star, first, second);
  else
    take_pairs(out, table, n_star, first, second);
  if (out.difference) {
    out.test.estimate = out.difference->estimate;
    out.test.se = out.difference->se;
    out.test.df = out.difference->df;
  }
  return out;
}

/// Tests the claim that a is better than b.
FamilyTest superiority(ScoreContrast contrast, const Family& family) {
  const bool one_sided = family.out.one_sided;
  HypothesisTest& test = contrast.test;
  if (!contrast.difference) {
    if (!contrast.unanimous) return {test};
    const Unanimous& all = *contrast.unanimous;
    return one_sided ? sign_test(contrast, all.p(better_side(contrast)))
                     : sign_test(contrast, all.p(Alternative::TwoSided), is_better(contrast, all.value));
  }
  const ScoreDifference& d = *contrast.difference;
  const bool better = is_better(contrast, d.estimate);
  test.t = d.t();
  test.p = d.p(one_sided ? better_side(contrast) : Alternative::TwoSided);
  set_paper(contrast, family);
  set_interval(contrast, 1 - 2 * level_of(family));
  return {test, one_sided || better};
}

/// Tests the claim that a and b differ by less than the margin, by two one-sided tests. Their larger p is
/// doubled unless the hypothesis is one-sided.
FamilyTest equivalence(ScoreContrast contrast, const Family& family) {
  const bool one_sided = family.out.one_sided;
  const double margin = contrast.margin;
  HypothesisTest& test = contrast.test;
  test.margin = margin;  // set even if the test is refused, since it was fixed beforehand
  const auto larger = [&](double lower, double upper) {
    return one_sided ? std::max(lower, upper) : std::min(1.0, 2 * std::max(lower, upper));
  };
  if (!contrast.difference) {
    if (!contrast.unanimous) return {test};
    const Unanimous& all = *contrast.unanimous;
    return sign_test(contrast,
                     larger(all.p(Alternative::Greater, -margin), all.p(Alternative::Less, margin)));
  }
  const ScoreDifference& d = *contrast.difference;
  const double lower = d.p(Alternative::Greater, -margin), upper = d.p(Alternative::Less, margin);
  test.t = d.t(lower > upper ? -margin : margin);
  test.p = larger(lower, upper);
  set_paper(contrast, family);
  set_interval(contrast, 1 - 2 * level_of(family));
  return {test};
}

/// Tests the claim that a is not worse than b by the margin or more.
FamilyTest non_inferiority(ScoreContrast contrast, const Family& family) {
  const bool one_sided = family.out.one_sided;
  const double worst = contrast.higher_is_better ? -contrast.margin : contrast.margin;
  const Alternative side = one_sided ? better_side(contrast) : Alternative::TwoSided;
  HypothesisTest& test = contrast.test;
  test.margin = contrast.margin;  // set even if the test is refused, since it was fixed beforehand
  if (!contrast.difference) {
    if (!contrast.unanimous) return {test};
    const Unanimous& all = *contrast.unanimous;
    return sign_test(contrast, all.p(side, worst), one_sided || is_better(contrast, all.value - worst));
  }
  const ScoreDifference& d = *contrast.difference;
  test.t = d.t(worst);
  test.p = d.p(side, worst);
  set_paper(contrast, family);
  set_interval(contrast, 1 - 2 * level_of(family));
  return {test, one_sided || is_better(contrast, d.estimate - worst)};
}

struct Scores {
  const AnalysisPlan& plan;
  const ScoreTable &realism, &sickness;
  /// Mixed models of realism and of sickness, in this order; empty if the plan uses paired tests.
  std::vector<Result<MixedScores>> models;
};

Scores scores_of(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan) {
  Scores out{plan, realism, sickness, {}};
  if (plan.tests == ScoreTests::Mixed) out.models = {fit_mixed_scores(realism), fit_mixed_scores(sickness)};
  return out;
}

/// Name of the tests in the text of a decision rule.
std::string tests_of(const Scores& scores) {
  return scores.plan.tests == ScoreTests::Mixed ? "t tests of the mixed model" : "paired t tests";
}

FamilyTest test_of(ScoreContrast contrast, const Family& family) {
  switch (family.claim.kind) {
    case HypothesisKind::Equivalence:
      return equivalence(std::move(contrast), family);
    case HypothesisKind::NonInferiority:
      return non_inferiority(std::move(contrast), family);
    case HypothesisKind::Superiority:
    case HypothesisKind::Preference:  // does not occur in Task 1
      break;
  }
  return superiority(std::move(contrast), family);
}

/// Adds a test for each score, pair of methods and n_* (nominal number of particles).
void add_tests(Family& family, const Scores& scores) {
  const MethodClaim& claim = family.claim;
  for (const std::string& score : claim.scores) {
    const bool first = score == "realism";
    const ScoreTable& table = first ? scores.realism : scores.sickness;
    const auto* model = scores.models.empty() ? nullptr : &scores.models[first ? 0 : 1];
    for (const std::string& a : claim.a) {
      for (const std::string& b : claim.b) {
        for (int n_star = 0; n_star < static_cast<int>(table.n_stars().size()); ++n_star)
          family.tests.push_back(test_of(score_contrast(claim, table, model, n_star, a, b), family));
      }
    }
  }
}

RuleWords rule_words(HypothesisKind kind, const std::string& tests) {
  if (kind == HypothesisKind::Equivalence) {
    const std::string rule = "two one-sided " + tests + " against the margins";
    return {rule, rule + ", p doubled", ""};
  }
  if (kind == HypothesisKind::NonInferiority) {
    const std::string rule = tests + " against the margins";
    return {"one-sided " + rule, rule + ", two-sided", "on the side of not worse"};
  }
  return {tests + ", one-sided (in the direction of better)", tests + ", two-sided",
          "in the direction of better"};
}

Hypothesis test_claim(const MethodClaim& claim, const Scores& scores, const std::string& untestable) {
  Family family = begin_family(claim, scores.plan, untestable);
  add_tests(family, scores);
  family.out.rule = rule_text(family.out, rule_words(claim.kind, tests_of(scores)), family.tests.size());
  return finish(std::move(family));
}

/// Adds the verdict of the paired tests to a hypothesis that the mixed model decides, and the verdict of the
/// procedure of the claim's paper, which uses paired tests.
void put_beside(Hypothesis& out, Hypothesis paired) {
  for (std::size_t i = 0; i < out.tests.size(); ++i) {
    out.tests[i].paper_p = paired.tests[i].paper_p;
    out.tests[i].paper_holds = paired.tests[i].paper_holds;
  }
  out.paper_supported = paired.paper_supported;
  out.paper_text = paired.paper_text;
  out.paired = {paired.status_if_testable, paired.confirmed, std::move(paired.tests)};
}

}  // namespace

std::vector<Hypothesis> task1_hypotheses(std::span<const MethodClaim> claims, const ScoreTable& realism,
                                         const ScoreTable& sickness, const AnalysisPlan& plan,
                                         const std::string& untestable) {
  const Scores scores = scores_of(realism, sickness, plan);
  std::vector<Hypothesis> out;
  for (const MethodClaim& claim : claims)
    if (claim.task == 1) out.push_back(test_claim(claim, scores, untestable));
  if (plan.tests == ScoreTests::Paired) return out;
  AnalysisPlan by_pairs = plan;
  by_pairs.tests = ScoreTests::Paired;
  auto paired = task1_hypotheses(claims, realism, sickness, by_pairs, untestable);
  for (std::size_t i = 0; i < out.size(); ++i) put_beside(out[i], std::move(paired[i]));
  return out;
}

namespace {

/// The level below which a test's uncorrected p must lie for the test to hold, given the other tests: alpha,
/// or under Holm alpha divided by the number of tests that Holm does not reject if this test has p = 1.
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

/// Range of estimates for which the test holds, with its standard error unchanged.
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
