/// Claims of Task 2: preferences between two methods.

#include <fmt/format.h>

#include <algorithm>

#include "stats/analysis/hypotheses.hpp"
#include "stats/analysis/hypothesis_family.hpp"

namespace stats {

namespace {

/// The test of each person's share of choices of a, used if a participant answered the pair more than once.
FamilyTest shares_of(HypothesisTest test, const PairPreference& pair, bool forwards, Alternative side,
                     const Family& family) {
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
  test.paper_holds = confirmed_as_in_paper(family.claim, *test.paper_p < family.plan.alpha, right);
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
    if (pair.shares) return shares_of(std::move(test), pair, forwards, side, family);
    test.reason = pair.test.reason();
    if (!pair.test) return {test};
    const auto own = binomial_test(*test.k, pair.n, 0.5, side, test.ci_confidence);
    test.estimate = own->estimate;
    test.ci = own->clopper_pearson;
    test.p = own->p;
    test.paper_p = pair.test->p;
    const bool right = own->estimate > 0.5;
    test.paper_holds = confirmed_as_in_paper(family.claim, *test.paper_p < plan.alpha, right);
    return {test, right};
  }
  test.reason = "the study does not show " + a + " and " + b;
  return {test};
}

/// Adds p after Holm over two larger families: the pairs of all claims, and all pairs.
void add_larger_families(Hypothesis& hypothesis, std::span<const MethodClaim> claims,
                         std::span<const PairPreference> pairs, const std::vector<std::string>& methods) {
  const auto five = holm_over_pairs(pairs, methods, [&](const std::string& a, const std::string& b) {
    return compares_pair(claims, a, b);
  });
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

std::vector<Hypothesis> task2_hypotheses(std::span<const MethodClaim> claims,
                                         std::span<const PairPreference> pairs,
                                         const std::vector<std::string>& methods, const AnalysisPlan& plan,
                                         const std::string& untestable) {
  std::vector<Hypothesis> out;
  for (const MethodClaim& claim : claims) {
    if (claim.task != 2) continue;
    Family family = begin_family(claim, plan, untestable);
    for (const std::string& a : claim.a)
      for (const std::string& b : claim.b) family.tests.push_back(preference(pairs, methods, a, b, family));
    const std::string test = family.tests.size() == 1 ? "exact binomial test" : "exact binomial tests";
    const std::string chosen =
        claim.called.empty() ? fmt::format("{}", fmt::join(claim.a, " or ")) : claim.called;
    family.out.rule = rule_text(
        family.out,
        {test + ", one-sided (" + chosen + " chosen more often)", test + ", two-sided", "more often chosen"},
        family.tests.size());
    out.push_back(finish(std::move(family)));
    if (claim.larger_families) add_larger_families(out.back(), claims, pairs, methods);
  }
  return out;
}

bool compares_pair(std::span<const MethodClaim> claims, const std::string& a, const std::string& b) {
  const auto among = [](const std::vector<std::string>& list, const std::string& one) {
    return std::find(list.begin(), list.end(), one) != list.end();
  };
  return std::any_of(claims.begin(), claims.end(), [&](const MethodClaim& claim) {
    return claim.task == 2 &&
           ((among(claim.a, a) && among(claim.b, b)) || (among(claim.a, b) && among(claim.b, a)));
  });
}

}  // namespace stats
