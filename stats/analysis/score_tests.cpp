#include "stats/analysis/score_tests.hpp"

#include <algorithm>
#include <cmath>

#include "stats/analysis/task1.hpp"
#include "stats/inference/distributions.hpp"

namespace stats {

namespace {

/// Omits the intervals of effect sizes, on which t_test_paired would spend most of its time; power
/// simulations call this often.
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

/// The exact test for differences that are all equal, which have no t. `p`: of that test.
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

/// The level of one side: alpha for a one-sided hypothesis, half of it for a two-sided one.
double level_of(const Family& family) {
  return family.out.one_sided ? family.plan.alpha : 0.5 * family.plan.alpha;
}

void set_interval(ScoreContrast& contrast, double confidence) {
  const ScoreDifference& d = *contrast.difference;
  const double half = student_upper_quantile(0.5 - 0.5 * confidence, d.df) * d.se;
  contrast.test.ci = {d.estimate - half, d.estimate + half};
  contrast.test.ci_confidence = confidence;
}

/// True if the uncorrected two-sided p, the only one in the paper, is below alpha.
bool paper_differs(const ScoreContrast& contrast, const Family& family) {
  return *contrast.test.paper_p < family.plan.alpha;
}

}  // namespace

double ScoreDifference::p(Alternative side, double null) const { return student_p(t(null), df, side); }

ScoreContrast score_contrast(const ScoreTable& table, const Result<MixedScores>* model, int n_star,
                             const std::string& a, const std::string& b) {
  const std::string& block = table.n_stars()[static_cast<std::size_t>(n_star)];
  ScoreContrast out;
  out.higher_is_better = table.scale().higher_is_better;
  out.margin = table.scale().margin;
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
  test.paper_holds = test.paper_p && paper_differs(contrast, family) && better;
  set_interval(contrast, 1 - 2 * level_of(family));
  return {test, one_sided || better};
}

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
  test.paper_holds = test.paper_p && !paper_differs(contrast, family);
  set_interval(contrast, 1 - 2 * level_of(family));
  return {test};
}

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
  test.paper_holds = test.paper_p && (!paper_differs(contrast, family) || is_better(contrast, d.estimate));
  set_interval(contrast, 1 - 2 * level_of(family));
  return {test, one_sided || is_better(contrast, d.estimate - worst)};
}

}  // namespace stats
