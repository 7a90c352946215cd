#include "stats/analysis/hypotheses.hpp"

#include <cmath>

#include "stats/analysis/hypothesis_family.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/inference/distributions.hpp"
#include "stats/inference/unanimous.hpp"

namespace stats {

namespace {

/// One comparison of Task 1: participants with both methods.
struct Contrast {
  HypothesisTest test;
  PairedValues pairs;
  std::optional<Unanimous> unanimous;  ///< all differences are the same
  bool higher_is_better = true;
  double margin = 0;
};

Contrast make_contrast(const ScoreTable& table, int n_star, const std::string& a, const std::string& b) {
  const std::string& block = table.n_stars()[static_cast<std::size_t>(n_star)];
  Contrast out;
  out.higher_is_better = table.scale().higher_is_better;
  out.margin = table.scale().margin;
  out.test.method = "paired t test";
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
  out.pairs = complete_pairs(table.column(n_star, first), table.column(n_star, second));
  out.test.n = out.pairs.x.size();
  if (const auto exact = exact_differences(table.means(n_star, first), table.means(n_star, second)))
    out.unanimous = unanimous(*exact);
  return out;
}

/// The uncorrected two-sided t test, which is all that the paper reports. Without the interval of the effect
/// size, which t_test_paired would spend most of its time on: simulations of power come here often.
struct TwoSided {
  double estimate = 0, p = 1;
  std::array<double, 2> ci{};
};

Result<TwoSided> two_sided_test(Contrast& contrast, const AnalysisPlan& plan) {
  if (!contrast.test.reason.empty()) return Refusal{contrast.test.reason};
  const auto paired =
      equivalence_paired(contrast.pairs.x, contrast.pairs.y, {-contrast.margin, contrast.margin}, plan.alpha);
  if (!paired) {
    contrast.test.reason = paired.reason();
    return Refusal{paired.reason()};
  }
  const double t = paired->estimate / paired->stderr_estimate;
  const double half =
      student_upper_quantile(0.5 - 0.5 * plan.confidence, paired->df) * paired->stderr_estimate;
  contrast.test.estimate = paired->estimate;
  contrast.test.t = t;
  contrast.test.df = paired->df;
  contrast.test.d_z = t / std::sqrt(static_cast<double>(contrast.test.n));
  contrast.test.paper_p = student_p(t, paired->df, Alternative::TwoSided);
  return TwoSided{
      paired->estimate, *contrast.test.paper_p, {paired->estimate - half, paired->estimate + half}};
}

/// Differences that are all the same have no t. `p`: of the exact test in its place.
FamilyTest sign_test(const Contrast& contrast, double p, bool right = true) {
  FamilyTest out{contrast.test, right};
  out.test.method = "exact sign test";
  out.test.reason.clear();
  out.test.estimate = contrast.unanimous->value;
  out.test.p = p;
  return out;
}

bool is_better(const Contrast& contrast, double difference) {
  return contrast.higher_is_better ? difference > 0 : difference < 0;
}

/// The interval of 1 - 2 level, which the tests against the margins decide by.
Result<EquivalenceTest> test_margins(Contrast& contrast, double level) {
  const auto both =
      equivalence_paired(contrast.pairs.x, contrast.pairs.y, {-contrast.margin, contrast.margin}, level);
  contrast.test.ci_confidence = 1 - 2 * level;
  if (both) contrast.test.ci = both->ci;
  return both;
}

/// The level of one side: each hypothesis has all of alpha on one side, or half of it on each.
double level_of(const Family& family) {
  return family.out.one_sided ? family.plan.alpha : 0.5 * family.plan.alpha;
}

FamilyTest superiority(Contrast contrast, const Family& family) {
  const AnalysisPlan& plan = family.plan;
  const auto t = two_sided_test(contrast, plan);
  const Alternative better_side = contrast.higher_is_better ? Alternative::Greater : Alternative::Less;
  if (!t && contrast.unanimous) {
    const Unanimous& all = *contrast.unanimous;
    return family.out.one_sided
               ? sign_test(contrast, all.p(better_side))
               : sign_test(contrast, all.p(Alternative::TwoSided), is_better(contrast, all.value));
  }
  if (!t) return {contrast.test};
  HypothesisTest& test = contrast.test;
  test.p = t->p;
  test.ci = t->ci;
  test.ci_confidence = plan.confidence;
  const bool better = is_better(contrast, t->estimate);
  test.paper_holds = t->p < plan.alpha && better;
  if (!family.out.one_sided) return {test, better};
  test.p = student_p(*test.t, *test.df, better_side);
  test_margins(contrast, plan.alpha);
  return {test};
}

FamilyTest equivalence(Contrast contrast, const Family& family) {
  contrast.test.margin = contrast.margin;  // also of a test that is refused: it was fixed beforehand
  const auto t = two_sided_test(contrast, family.plan);
  if (!t && contrast.unanimous) {
    const double p = std::max(contrast.unanimous->p(Alternative::Greater, -contrast.margin),
                              contrast.unanimous->p(Alternative::Less, contrast.margin));
    return sign_test(contrast, family.out.one_sided ? p : std::min(1.0, 2 * p));
  }
  if (!t) return {contrast.test};
  const auto both = test_margins(contrast, level_of(family));
  contrast.test.p = family.out.one_sided ? both->p : std::min(1.0, 2 * both->p);
  contrast.test.t = both->p_lower > both->p_upper ? both->t_lower : both->t_upper;
  contrast.test.paper_holds = t->p >= family.plan.alpha;
  return {contrast.test};
}

FamilyTest non_inferiority(Contrast contrast, const Family& family) {
  contrast.test.margin = contrast.margin;  // also of a test that is refused: it was fixed beforehand
  const auto t = two_sided_test(contrast, family.plan);
  if (!t && contrast.unanimous) {
    const Unanimous& all = *contrast.unanimous;
    const double worst = contrast.higher_is_better ? -contrast.margin : contrast.margin;
    if (family.out.one_sided)
      return sign_test(contrast,
                       all.p(contrast.higher_is_better ? Alternative::Greater : Alternative::Less, worst));
    return sign_test(contrast, all.p(Alternative::TwoSided, worst), is_better(contrast, all.value - worst));
  }
  if (!t) return {contrast.test};
  test_margins(contrast, level_of(family));
  const auto one =
      non_inferiority_paired(contrast.pairs.x, contrast.pairs.y, contrast.margin,
                             contrast.higher_is_better ? Better::Higher : Better::Lower, level_of(family));
  contrast.test.t = one->t;
  contrast.test.paper_holds = t->p >= family.plan.alpha || is_better(contrast, t->estimate);
  contrast.test.p = family.out.one_sided ? one->p : student_p(one->t, one->df, Alternative::TwoSided);
  return {contrast.test, family.out.one_sided || one->p < 0.5};
}

using Contrasts = std::vector<Contrast>;

/// Score by method by n_*.
Contrasts contrasts(const ScoreTable& realism, const ScoreTable& sickness, const std::vector<std::string>& a,
                    const std::string& b) {
  Contrasts out;
  for (const ScoreTable* table : {&realism, &sickness}) {
    for (const std::string& method : a) {
      for (int n_star = 0; n_star < static_cast<int>(table->n_stars().size()); ++n_star)
        out.push_back(make_contrast(*table, n_star, method, b));
    }
  }
  return out;
}

template <class Test>
void add_tests(Family& family, const Contrasts& list, Test test) {
  for (const Contrast& contrast : list) family.tests.push_back(test(contrast, family));
}

Hypothesis test_h1(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan,
                   const std::string& untestable) {
  Family family = begin_family("H1", HypothesisKind::Superiority, plan, untestable);
  family.out.title =
      "Our method exhibits superior performance compared to FovFluid in various scenes and baseline "
      "configurations.";
  family.out.paper_rule = "every uncorrected t test significant, in the direction of better";
  family.out.paper_published = "confirmed";
  add_tests(family, contrasts(realism, sickness, {ours, ours_tsp}, fov_fluid), superiority);
  family.out.rule = rule_text(family.out,
                              {"paired t tests, one-sided (in the direction of better)",
                               "paired t tests, two-sided", "in the direction of better"},
                              family.tests.size());
  return finish(std::move(family));
}

Hypothesis test_h2(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan) {
  Family family = begin_family("H2", HypothesisKind::Equivalence, plan, "");
  family.out.title =
      "Our method achieves visual effects comparable to HiRes in various scenes and baseline configurations.";
  family.out.paper_rule = "no uncorrected t test significant; absence of a difference is not shown by that";
  family.out.paper_published =
      "no conclusive evidence to fully support it; Ours-TSp comparable to HiRes or better at the low "
      "baseline";
  add_tests(family, contrasts(realism, sickness, {ours, ours_tsp}, hi_res), equivalence);
  family.out.rule = rule_text(family.out,
                              {"two one-sided paired t tests against the margins",
                               "two one-sided paired t tests against the margins, p doubled", ""},
                              family.tests.size());
  return finish(std::move(family));
}

Hypothesis test_h3(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan) {
  Family family = begin_family("H3", HypothesisKind::NonInferiority, plan, "");
  family.out.title = "Our acceleration strategy did not degrade visual perception of our naive strategy.";
  family.out.paper_rule = "no uncorrected t test significant in the direction of worse";
  family.out.paper_published = "holds true";
  add_tests(family, contrasts(realism, sickness, {ours_tsp}, ours), non_inferiority);
  family.out.rule = rule_text(family.out,
                              {"one-sided paired t tests against the margins",
                               "paired t tests against the margins, two-sided", "on the side of not worse"},
                              family.tests.size());
  return finish(std::move(family));
}

}  // namespace

std::vector<Hypothesis> task1_hypotheses(const ScoreTable& realism, const ScoreTable& sickness,
                                         const AnalysisPlan& plan, const std::string& untestable) {
  return {test_h1(realism, sickness, plan, untestable), test_h2(realism, sickness, plan),
          test_h3(realism, sickness, plan)};
}

}  // namespace stats
