#include "stats/analysis/hypotheses.hpp"

#include <cmath>

#include "stats/analysis/hypothesis_family.hpp"
#include "stats/analysis/task1.hpp"
#include "stats/inference/distributions.hpp"

namespace stats {

namespace {

constexpr const char* ours = "Ours";
constexpr const char* ours_tsp = "Ours-TSp";
constexpr const char* fov_fluid = "FovFluid";
constexpr const char* hi_res = "HiRes";

/// One comparison of Task 1: participants with both methods.
struct Contrast {
  HypothesisTest test;
  PairedValues pairs;
  bool higher_is_better = true;
  double margin = 0;
};

Contrast make_contrast(const ScoreTable& table, int n_star, const std::string& a, const std::string& b) {
  const std::string& block = table.n_stars()[static_cast<std::size_t>(n_star)];
  Contrast out;
  out.higher_is_better = table.scale().higher_is_better;
  out.margin = table.scale().margin;
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

bool is_better(const Contrast& contrast, double difference) {
  return contrast.higher_is_better ? difference > 0 : difference < 0;
}

FamilyTest superiority(Contrast contrast, const AnalysisPlan& plan) {
  const auto t = two_sided_test(contrast, plan);
  if (!t) return {contrast.test};
  HypothesisTest& test = contrast.test;
  test.p = t->p;
  test.ci = t->ci;
  test.ci_confidence = plan.confidence;
  const bool better = is_better(contrast, t->estimate);
  test.paper_holds = t->p < plan.alpha && better;
  return {test, better};
}

/// Both kinds of tests against a margin show the interval of 1 - 2 alpha.
Result<EquivalenceTest> test_margins(Contrast& contrast, const AnalysisPlan& plan) {
  const auto both =
      equivalence_paired(contrast.pairs.x, contrast.pairs.y, {-contrast.margin, contrast.margin}, plan.alpha);
  contrast.test.ci_confidence = 1 - 2 * plan.alpha;
  if (both) contrast.test.ci = both->ci;
  return both;
}

FamilyTest equivalence(Contrast contrast, const AnalysisPlan& plan) {
  contrast.test.margin = contrast.margin;  // also of a test that is refused: it was fixed beforehand
  const auto t = two_sided_test(contrast, plan);
  if (!t) return {contrast.test};
  const auto both = test_margins(contrast, plan);
  contrast.test.p = both->p;
  contrast.test.t = both->p_lower > both->p_upper ? both->t_lower : both->t_upper;
  contrast.test.paper_holds = t->p >= plan.alpha;
  return {contrast.test};
}

FamilyTest non_inferiority(Contrast contrast, const AnalysisPlan& plan) {
  contrast.test.margin = contrast.margin;  // also of a test that is refused: it was fixed beforehand
  const auto t = two_sided_test(contrast, plan);
  if (!t) return {contrast.test};
  test_margins(contrast, plan);
  const auto one =
      non_inferiority_paired(contrast.pairs.x, contrast.pairs.y, contrast.margin,
                             contrast.higher_is_better ? Better::Higher : Better::Lower, plan.alpha);
  contrast.test.p = one->p;
  contrast.test.t = one->t;
  contrast.test.paper_holds = t->p >= plan.alpha || is_better(contrast, t->estimate);
  return {contrast.test};
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
  for (const Contrast& contrast : list) family.tests.push_back(test(contrast, family.plan));
}

/// One answer of Task 2: a preferred to b.
FamilyTest preference(std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
                      const std::string& a, const std::string& b, Alternative side,
                      const AnalysisPlan& plan) {
  HypothesisTest test;
  test.label = a + " preferred to " + b;
  test.a = a;
  test.b = b;
  test.ci_confidence = plan.confidence;
  for (const PairPreference& pair : pairs) {
    const std::string& first = methods[static_cast<std::size_t>(pair.a)];
    const std::string& second = methods[static_cast<std::size_t>(pair.b)];
    const bool forwards = first == a && second == b;
    if (!forwards && !(first == b && second == a)) continue;
    test.n = static_cast<std::size_t>(pair.n);
    test.k = forwards ? pair.k : pair.n - pair.k;
    test.reason = pair.test.reason();
    if (!pair.test) return {test};
    const auto own = binomial_test(*test.k, pair.n, 0.5, side, plan.confidence);
    test.estimate = own->estimate;
    test.ci = own->clopper_pearson;
    test.p = own->p;
    test.paper_p = pair.test->p;
    return {test, own->estimate > 0.5};
  }
  test.reason = "the study does not show " + a + " and " + b;
  return {test};
}

/// Holm over the pairs of a larger family.
void add_larger_families(Hypothesis& hypothesis, std::span<const PairPreference> pairs,
                         const std::vector<std::string>& methods) {
  const auto five = holm_over_pairs(pairs, methods, in_paper_figure_10);
  for (HypothesisTest& test : hypothesis.tests) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::string& a = methods[static_cast<std::size_t>(pairs[i].a)];
      const std::string& b = methods[static_cast<std::size_t>(pairs[i].b)];
      if (!(a == test.a && b == test.b) && !(a == test.b && b == test.a)) continue;
      test.p_holm_of_ten = pairs[i].p_holm;
      test.p_holm_of_five = five[i];
    }
  }
}

Family preference_family(const char* id, const AnalysisPlan& plan, const std::string& untestable) {
  Family family{plan, untestable, {}, {}};
  family.out.id = id;
  family.out.task = 2;
  family.out.kind = HypothesisKind::Preference;
  return family;
}

Family task1_family(const char* id, HypothesisKind kind, const AnalysisPlan& plan,
                    const std::string& untestable) {
  Family family{plan, untestable, {}, {}};
  family.out.id = id;
  family.out.kind = kind;
  return family;
}

Hypothesis test_h1(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan,
                   const std::string& untestable) {
  Family family = task1_family("H1", HypothesisKind::Superiority, plan, untestable);
  family.out.title =
      "Our method exhibits superior performance compared to FovFluid in various scenes and baseline "
      "configurations.";
  family.out.rule = "paired t tests, two-sided, significant after Holm and in the direction of better";
  family.out.paper_rule = "every uncorrected t test significant, in the direction of better";
  family.out.paper_published = "confirmed";
  add_tests(family, contrasts(realism, sickness, {ours, ours_tsp}, fov_fluid), superiority);
  return finish(std::move(family));
}

Hypothesis test_h2(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan) {
  Family family = task1_family("H2", HypothesisKind::Equivalence, plan, "");
  family.out.title =
      "Our method achieves visual effects comparable to HiRes in various scenes and baseline configurations.";
  family.out.rule = "two one-sided paired t tests against the margins, significant after Holm";
  family.out.paper_rule = "no uncorrected t test significant; absence of a difference is not shown by that";
  family.out.paper_published =
      "no conclusive evidence to fully support it; Ours-TSp comparable to HiRes or better at the low "
      "baseline";
  add_tests(family, contrasts(realism, sickness, {ours, ours_tsp}, hi_res), equivalence);
  return finish(std::move(family));
}

Hypothesis test_h3(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan) {
  Family family = task1_family("H3", HypothesisKind::NonInferiority, plan, "");
  family.out.title = "Our acceleration strategy did not degrade visual perception of our naive strategy.";
  family.out.rule = "one-sided paired t tests against the margins, significant after Holm";
  family.out.paper_rule = "no uncorrected t test significant in the direction of worse";
  family.out.paper_published = "holds true";
  add_tests(family, contrasts(realism, sickness, {ours_tsp}, ours), non_inferiority);
  return finish(std::move(family));
}

}  // namespace

std::vector<Hypothesis> task1_hypotheses(const ScoreTable& realism, const ScoreTable& sickness,
                                         const AnalysisPlan& plan, const std::string& untestable) {
  return {test_h1(realism, sickness, plan, untestable), test_h2(realism, sickness, plan),
          test_h3(realism, sickness, plan)};
}

std::vector<Hypothesis> task2_hypotheses(std::span<const PairPreference> pairs,
                                         const std::vector<std::string>& methods, const AnalysisPlan& plan,
                                         const std::string& untestable) {
  const auto test = [&](const char* a, const char* b, Alternative side) {
    FamilyTest out = preference(pairs, methods, a, b, side, plan);
    if (out.test.p) out.test.paper_holds = *out.test.paper_p < plan.alpha && out.right;
    return out;
  };
  Family h4 = preference_family("H4", plan, "");
  h4.out.title = "Users will prefer the acceleration strategy.";
  h4.out.rule = "exact binomial test, two-sided, significant and more often chosen";
  h4.out.paper_rule = "uncorrected binomial test significant";
  h4.out.paper_published = "not confirmed";
  h4.tests = {test(ours_tsp, ours, Alternative::TwoSided)};

  Family h5 = preference_family("H5", plan, untestable);
  h5.out.title = "When faced with FovFluid and our method, users will prefer our method.";
  h5.out.rule = "exact binomial tests, two-sided, significant after Holm and more often chosen";
  h5.out.paper_rule = "every uncorrected binomial test significant";
  h5.out.paper_published = "supported (p = 0.029, p = 0.002)";
  h5.tests = {test(ours, fov_fluid, Alternative::TwoSided), test(ours_tsp, fov_fluid, Alternative::TwoSided)};

  Family h6 = preference_family("H6", plan, "");
  h6.out.title = "When faced with HiRes and our method, users will tend to choose HiRes.";
  h6.out.rule = "exact binomial tests, one-sided (HiRes chosen more often), significant after Holm";
  h6.out.paper_rule =
      "no uncorrected binomial test significant; that confirms nothing, though the paper says so";
  h6.out.paper_published = "no significant difference, said to confirm it";
  h6.tests = {test(hi_res, ours, Alternative::Greater), test(hi_res, ours_tsp, Alternative::Greater)};
  for (FamilyTest& one : h6.tests) one.test.paper_holds = one.test.paper_p && *one.test.paper_p >= plan.alpha;

  std::vector<Hypothesis> out{finish(std::move(h4)), finish(std::move(h5)), finish(std::move(h6))};
  add_larger_families(out[0], pairs, methods);
  add_larger_families(out[1], pairs, methods);
  return out;
}

bool in_paper_figure_10(const std::string& a, const std::string& b) {
  const auto pair = [&](const char* x, const char* y) { return (a == x && b == y) || (a == y && b == x); };
  return pair(ours, ours_tsp) || pair(ours, fov_fluid) || pair(ours_tsp, fov_fluid) || pair(ours, hi_res) ||
         pair(ours_tsp, hi_res);
}

}  // namespace stats
