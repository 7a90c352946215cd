/// H4 to H6: preferences between two methods.

#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/hypothesis_family.hpp"

namespace stats {

namespace {

/// The test of each person's share of choices of a, used if some answered more than once.
FamilyTest shares_of(HypothesisTest test, const PairPreference& pair, bool forwards, Alternative side,
                     double alpha) {
  std::vector<PersonChoices> people = pair.people;
  for (auto& one : people)
    if (!forwards) one.k = one.n - one.k;
  const auto own = share_test(people, side, test.ci_confidence);
  test.method = share_test_name;
  test.estimate = own->share;
  test.ci = own->ci;
  test.p = own->p;
  test.paper_p = pair.shares->p;
  const bool right = own->share > 0.5;
  test.paper_holds = *test.paper_p < alpha && right;
  return {test, right};
}

/// The test that a is preferred to b.
FamilyTest preference(std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
                      const std::string& a, const std::string& b, const Family& family) {
  const AnalysisPlan& plan = family.plan;
  const Alternative side = family.out.one_sided ? Alternative::Greater : Alternative::TwoSided;
  HypothesisTest test;
  test.method = "exact binomial test";
  test.label = a + " preferred to " + b;
  test.a = a;
  test.b = b;
  test.ci_confidence = 1 - plan.alpha;
  for (const PairPreference& pair : pairs) {
    const std::string& first = methods[static_cast<std::size_t>(pair.a)];
    const std::string& second = methods[static_cast<std::size_t>(pair.b)];
    const bool forwards = first == a && second == b;
    if (!forwards && !(first == b && second == a)) continue;
    test.n = static_cast<std::size_t>(pair.n);
    test.k = forwards ? pair.k : pair.n - pair.k;
    if (pair.shares) return shares_of(std::move(test), pair, forwards, side, plan.alpha);
    test.reason = pair.test.reason();
    if (!pair.test) return {test};
    const auto own = binomial_test(*test.k, pair.n, 0.5, side, test.ci_confidence);
    test.estimate = own->estimate;
    test.ci = own->clopper_pearson;
    test.p = own->p;
    test.paper_p = pair.test->p;
    const bool right = own->estimate > 0.5;
    test.paper_holds = *test.paper_p < plan.alpha && right;
    return {test, right};
  }
  test.reason = "the study does not show " + a + " and " + b;
  return {test};
}

/// Adds p after Holm over two larger families: the five pairs of the paper's Fig. 10, and all pairs.
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

}  // namespace

std::vector<Hypothesis> task2_hypotheses(std::span<const PairPreference> pairs,
                                         const std::vector<std::string>& methods, const AnalysisPlan& plan,
                                         const std::string& untestable) {
  const auto add = [&](Family& family, const char* a, const char* b) {
    family.tests.push_back(preference(pairs, methods, a, b, family));
  };
  const auto words = [&](Family& family, const std::string& test, const std::string& chosen) {
    family.out.rule = rule_text(
        family.out,
        {test + ", one-sided (" + chosen + " chosen more often)", test + ", two-sided", "more often chosen"},
        family.tests.size());
  };
  Family h4 = begin_family("H4", HypothesisKind::Preference, plan, "");
  h4.out.title = "Users will prefer the acceleration strategy.";
  h4.out.paper_rule = "uncorrected binomial test significant";
  h4.out.paper_published = "not confirmed";
  add(h4, ours_tsp, ours);
  words(h4, "exact binomial test", ours_tsp);

  Family h5 = begin_family("H5", HypothesisKind::Preference, plan, untestable);
  h5.out.title = "When faced with FovFluid and our method, users will prefer our method.";
  h5.out.paper_rule = "every uncorrected binomial test significant";
  h5.out.paper_published = "supported (p = 0.029, p = 0.002)";
  add(h5, ours, fov_fluid);
  add(h5, ours_tsp, fov_fluid);
  words(h5, "exact binomial tests", "ours");

  Family h6 = begin_family("H6", HypothesisKind::Preference, plan, "");
  h6.out.title = "When faced with HiRes and our method, users will tend to choose HiRes.";
  h6.out.paper_rule =
      "no uncorrected binomial test significant; that confirms nothing, though the paper says so";
  h6.out.paper_published = "no significant difference, said to confirm it";
  add(h6, hi_res, ours);
  add(h6, hi_res, ours_tsp);
  words(h6, "exact binomial tests", hi_res);
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
