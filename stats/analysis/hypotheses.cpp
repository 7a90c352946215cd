#include "stats/analysis/hypotheses.hpp"

#include "stats/analysis/score_tests.hpp"

namespace stats {

namespace {

/// The data for the tests of H1 to H3.
struct Scores {
  const AnalysisPlan& plan;
  const ScoreTable &realism, &sickness;
  std::vector<Result<MixedScores>> models;  ///< of both scores, if the plan uses the mixed model
};

Scores scores_of(const ScoreTable& realism, const ScoreTable& sickness, const AnalysisPlan& plan) {
  Scores out{plan, realism, sickness, {}};
  if (plan.tests == ScoreTests::Mixed) out.models = {fit_mixed_scores(realism), fit_mixed_scores(sickness)};
  return out;
}

/// The tests' name in a rule, as "paired t tests".
std::string tests_of(const Scores& scores) {
  return scores.plan.tests == ScoreTests::Mixed ? "t tests of the mixed model" : "paired t tests";
}

/// Adds a test for each score, method and n_*.
template <class Test>
void add_tests(Family& family, const Scores& scores, const std::vector<std::string>& a, const std::string& b,
               Test test) {
  for (const ScoreTable* table : {&scores.realism, &scores.sickness}) {
    const auto* model = scores.models.empty() ? nullptr : &scores.models[table == &scores.realism ? 0 : 1];
    for (const std::string& method : a) {
      for (int n_star = 0; n_star < static_cast<int>(table->n_stars().size()); ++n_star)
        family.tests.push_back(test(score_contrast(*table, model, n_star, method, b), family));
    }
  }
}

Hypothesis test_h1(const Scores& scores, const std::string& untestable) {
  Family family = begin_family("H1", HypothesisKind::Superiority, scores.plan, untestable);
  family.out.title =
      "Our method exhibits superior performance compared to FovFluid in various scenes and baseline "
      "configurations.";
  family.out.paper_rule = "every uncorrected t test significant, in the direction of better";
  family.out.paper_published = "confirmed";
  add_tests(family, scores, {ours, ours_tsp}, fov_fluid, superiority);
  family.out.rule = rule_text(family.out,
                              {tests_of(scores) + ", one-sided (in the direction of better)",
                               tests_of(scores) + ", two-sided", "in the direction of better"},
                              family.tests.size());
  return finish(std::move(family));
}

Hypothesis test_h2(const Scores& scores) {
  Family family = begin_family("H2", HypothesisKind::Equivalence, scores.plan, "");
  family.out.title =
      "Our method achieves visual effects comparable to HiRes in various scenes and baseline configurations.";
  family.out.paper_rule = "no uncorrected t test significant; absence of a difference is not shown by that";
  family.out.paper_published =
      "no conclusive evidence to fully support it; Ours-TSp comparable to HiRes or better at the low "
      "baseline";
  add_tests(family, scores, {ours, ours_tsp}, hi_res, equivalence);
  const std::string rule = "two one-sided " + tests_of(scores) + " against the margins";
  family.out.rule = rule_text(family.out, {rule, rule + ", p doubled", ""}, family.tests.size());
  return finish(std::move(family));
}

Hypothesis test_h3(const Scores& scores) {
  Family family = begin_family("H3", HypothesisKind::NonInferiority, scores.plan, "");
  family.out.title = "Our acceleration strategy did not degrade visual perception of our naive strategy.";
  family.out.paper_rule = "no uncorrected t test significant in the direction of worse";
  family.out.paper_published = "holds true";
  add_tests(family, scores, {ours_tsp}, ours, non_inferiority);
  const std::string rule = tests_of(scores) + " against the margins";
  family.out.rule =
      rule_text(family.out, {"one-sided " + rule, rule + ", two-sided", "on the side of not worse"},
                family.tests.size());
  return finish(std::move(family));
}

/// Adds the paired verdict to one by the mixed model; the paper's own procedure uses paired tests.
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

std::vector<Hypothesis> task1_hypotheses(const ScoreTable& realism, const ScoreTable& sickness,
                                         const AnalysisPlan& plan, const std::string& untestable) {
  const Scores scores = scores_of(realism, sickness, plan);
  std::vector<Hypothesis> out{test_h1(scores, untestable), test_h2(scores), test_h3(scores)};
  if (plan.tests == ScoreTests::Paired) return out;
  AnalysisPlan by_pairs = plan;
  by_pairs.tests = ScoreTests::Paired;
  auto paired = task1_hypotheses(realism, sickness, by_pairs, untestable);
  for (std::size_t i = 0; i < out.size(); ++i) put_beside(out[i], std::move(paired[i]));
  return out;
}

}  // namespace stats
