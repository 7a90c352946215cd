#include "stats/analysis/declared_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "stats/inference/binomial.hpp"
#include "stats/inference/equivalence.hpp"
#include "stats/inference/linear_mixed.hpp"
#include "stats/inference/t_test.hpp"
#include "stats/inference/wilcoxon.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

struct TestNames {
  const char* word;
  const char* name;
};
/// In the order of TestKind.
constexpr std::array<TestNames, 8> test_names{{{"paired_t", "paired t test"},
                                               {"wilcoxon", "Wilcoxon signed-rank test"},
                                               {"binomial", "exact sign test"},
                                               {"tost", "two one-sided t tests"},
                                               {"welch_t", "Welch's t test"},
                                               {"student_t", "Student's t test"},
                                               {"mixed", "linear mixed model"},
                                               {"clmm", "cumulative-link mixed model"}}};
constexpr std::array alternative_names{"two-sided", "less", "greater"};

bool is_t_test(TestKind kind) {
  return kind == TestKind::PairedT || kind == TestKind::WelchT || kind == TestKind::StudentT;
}

void check_margin(const DeclaredTest& test) {
  if (test.kind == TestKind::Tost && (!test.margin || test.alternative != Alternative::TwoSided))
    throw std::invalid_argument(
        "run_declared: an equivalence test without a margin or with a side; set DeclaredTest::margin and "
        "Alternative::TwoSided");
  if (!test.margin) return;
  if (!(*test.margin > 0))
    throw std::invalid_argument(
        "run_declared: the margin is not above 0; set DeclaredTest::margin to a positive number");
  if (test.kind == TestKind::Tost) return;
  if (!is_t_test(test.kind) || test.alternative == Alternative::TwoSided)
    throw std::invalid_argument(
        "run_declared: only equivalence and one-sided t tests have a margin; leave DeclaredTest::margin "
        "empty");
}

std::vector<double> values_of_means(std::span<const ExactMean> means) {
  std::vector<double> out;
  for (const ExactMean& one : means) out.push_back(one.value());
  return out;
}

TTestOptions t_options(const DeclaredTest& test) {
  TTestOptions out{test.alternative, test.confidence, 0, true};
  if (test.margin) out.null_value = test.alternative == Alternative::Greater ? -*test.margin : *test.margin;
  return out;
}

TestOutcome t_outcome(const TTest& test) {
  TestOutcome out;
  out.statistic = "t";
  out.value = test.t;
  out.df = test.df;
  out.p = test.p;
  out.estimated = "mean difference";
  out.estimate = test.estimate;
  out.ci = test.ci;
  out.n_missing = static_cast<int>(test.n_missing);
  return out;
}

Result<TestOutcome> run_paired_t(const DeclaredTest& test, std::span<const ExactMean> a,
                                 std::span<const ExactMean> b) {
  const auto got = t_test_paired(values_of_means(a), values_of_means(b), t_options(test));
  if (!got) return Refusal{got.reason()};
  TestOutcome out = t_outcome(*got);
  out.n_a = out.n_b = static_cast<int>(got->n);
  out.effect = "d_z";
  out.effect_size = got->cohen_dz;
  out.effect_ci = got->cohen_dz_ci;
  return out;
}

Result<TestOutcome> run_group_t(const DeclaredTest& test, std::span<const ExactMean> a,
                                std::span<const ExactMean> b) {
  const auto x = values_of_means(a), y = values_of_means(b);
  const auto options = t_options(test);
  const auto got =
      test.kind == TestKind::WelchT ? t_test_welch(x, y, options) : t_test_independent(x, y, options);
  if (!got) return Refusal{got.reason()};
  TestOutcome out = t_outcome(*got);
  out.n_a = static_cast<int>(got->n_x);
  out.n_b = static_cast<int>(got->n_y);
  out.groups = true;
  out.effect = "d_s";
  out.effect_size = got->cohen_ds;
  out.effect_ci = got->cohen_ds_ci;
  return out;
}

Result<TestOutcome> run_equivalence(const DeclaredTest& test, std::span<const ExactMean> a,
                                    std::span<const ExactMean> b) {
  const auto got = equivalence_paired(values_of_means(a), values_of_means(b), {-*test.margin, *test.margin},
                                      1 - test.confidence);
  if (!got) return Refusal{got.reason()};
  TestOutcome out;
  out.statistic = "t";
  out.value = got->p_lower > got->p_upper ? got->t_lower : got->t_upper;
  out.df = got->df;
  out.p = got->p;
  out.estimated = "mean difference";
  out.estimate = got->estimate;
  out.ci = got->ci;
  out.n_a = out.n_b = static_cast<int>(got->n);
  out.n_missing = static_cast<int>(got->n_missing);
  return out;
}

/// p for the alternative. A one-sided p is exact if there is one, else it is p_normal / 2 on the side of the
/// larger rank sum and 1 - p_normal / 2 on the other side.
double signed_rank_p(const SignedRank& test, Alternative alternative) {
  if (alternative == Alternative::TwoSided) return test.p();
  const bool greater = alternative == Alternative::Greater;
  if (const auto& exact = greater ? test.p_exact_greater : test.p_exact_less) return *exact;
  const bool right_side = greater ? test.w_plus > test.w_minus : test.w_plus < test.w_minus;
  return right_side ? test.p_normal / 2 : 1 - test.p_normal / 2;
}

Result<TestOutcome> run_wilcoxon(const DeclaredTest& test, std::span<const ExactMean> a,
                                 std::span<const ExactMean> b) {
  const auto differences = exact_differences(a, b);
  if (!differences) return Refusal{differences.reason()};
  const auto got = signed_rank(*differences, test.confidence);
  if (!got) return Refusal{got.reason()};
  TestOutcome out;
  out.statistic = "W+";
  out.value = got->w_plus;
  out.p = signed_rank_p(*got, test.alternative);
  out.estimated = "Hodges-Lehmann shift";
  out.estimate = got->hodges_lehmann;
  out.ci = got->hodges_lehmann_ci;
  out.effect = "rank-biserial correlation";
  out.effect_size = got->rank_biserial;
  out.n_a = out.n_b = static_cast<int>(got->n);
  out.n_missing = static_cast<int>(differences->n_missing);
  if (test.alternative != Alternative::TwoSided) out.note = "the interval is two-sided";
  return out;
}

Result<TestOutcome> run_sign_test(const DeclaredTest& test, std::span<const ExactMean> a,
                                  std::span<const ExactMean> b) {
  const auto differences = exact_differences(a, b);
  if (!differences) return Refusal{differences.reason()};
  double above = 0, unequal = 0;
  for (const double one : differences->numerators) {
    above += one > 0 ? 1 : 0;
    unequal += one != 0 ? 1 : 0;
  }
  if (unequal == 0) return Refusal{"no participant has unequal values"};
  const auto got = binomial_test(above, unequal, 0.5, test.alternative, test.confidence);
  if (!got) return Refusal{got.reason()};
  TestOutcome out;
  out.statistic = "k";
  out.value = got->k;
  out.p = got->p;
  out.estimated = "share above";
  out.estimate = got->estimate;
  out.ci = got->clopper_pearson;
  out.effect = "Cohen's g";
  out.effect_size = got->cohen_g;
  out.n_a = out.n_b = static_cast<int>(unequal);
  out.n_missing = static_cast<int>(differences->n_missing);
  const std::size_t equal = differences->numerators.size() - static_cast<std::size_t>(unequal);
  if (equal > 0) out.note = std::to_string(equal) + " with equal values left out";
  return out;
}

/// The p of a side from the two-sided p of a symmetric statistic.
double side_p(double statistic, double two_sided, Alternative alternative) {
  if (alternative == Alternative::TwoSided) return two_sided;
  const bool right_side = alternative == Alternative::Greater ? statistic > 0 : statistic < 0;
  return right_side ? two_sided / 2 : 1 - two_sided / 2;
}

/// Confidence of the two-sided interval. For a one-sided test it is lower, so that each end alone is a
/// one-sided bound with the confidence of the test.
double interval_confidence(const DeclaredTest& test) {
  return test.alternative == Alternative::TwoSided ? test.confidence : 2 * test.confidence - 1;
}

std::array<double, 2> one_side_of(std::array<double, 2> ci, Alternative alternative) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (alternative == Alternative::Greater) ci[1] = infinite;
  if (alternative == Alternative::Less) ci[0] = -infinite;
  return ci;
}

void count_people(TestOutcome& out, const AnswerRows& rows) {
  std::array<std::set<int>, 2> people;
  for (std::size_t i = 0; i < rows.participant.size(); ++i)
    people[rows.condition[i] == 0 ? 0 : 1].insert(rows.participant[i]);
  out.n_a = static_cast<int>(people[0].size());
  out.n_b = static_cast<int>(people[1].size());
  out.groups = std::ranges::none_of(people[0], [&](int person) { return people[1].contains(person); });
}

/// A note that names the variances which a linear mixed model estimates as zero; empty if there are none. In
/// a comparison of groups each participant has one condition, so that a participant's part by condition
/// cannot be told from the participant's own.
std::string singular_note(const LinearMixedFit& fit, bool groups) {
  const bool level = fit.singular.find("level") != std::string::npos,
             condition = fit.singular.find("by method") != std::string::npos;
  if (groups) return level && condition ? "the variance between participants is estimated as zero" : "";
  if (level && condition)
    return "the variances between participants, in level and by condition, are estimated as zero";
  if (level) return "the variance between participants is estimated as zero";
  return condition ? "the variance of participants by condition is estimated as zero" : "";
}

Predictor of_a(const AnswerRows& rows) {
  Predictor out{"a", {}};
  for (const int condition : rows.condition) out.values.push_back(condition == 0 ? 1 : 0);
  return out;
}

Result<TestOutcome> run_linear_mixed(const DeclaredTest& test, const AnswerRows& rows) {
  std::vector<Predictor> terms{{"intercept", std::vector<double>(rows.answer.size(), 1)}, of_a(rows)};
  terms.insert(terms.end(), rows.terms.begin(), rows.terms.end());
  const auto fit = fit_linear_mixed(rows.answer, terms, rows.participant, rows.condition);
  if (!fit) return Refusal{fit.reason()};
  const int term = fit->index_of("a");
  if (term < 0) return Refusal{"the two conditions cannot be told apart"};
  std::vector<double> weights(fit->beta.size());
  weights[static_cast<std::size_t>(term)] = 1;
  const auto got = fit->contrast(weights, interval_confidence(test));
  TestOutcome out;
  out.statistic = "t";
  out.value = got.t;
  out.df = got.df;
  out.p = side_p(got.t, got.p, test.alternative);
  out.estimated = "mean difference";
  out.estimate = got.estimate;
  out.ci = one_side_of(got.ci, test.alternative);
  count_people(out, rows);
  out.note = singular_note(*fit, out.groups);
  return out;
}

Result<TestOutcome> run_link_mixed(const DeclaredTest& test, const AnswerRows& rows) {
  std::vector<Predictor> terms{of_a(rows)};
  terms.insert(terms.end(), rows.terms.begin(), rows.terms.end());
  const auto fit =
      fit_cumulative_link_mixed(rows.answer, terms, rows.participant, Link::Logit, 15, Separation::Penalise);
  if (!fit) return Refusal{fit.reason()};
  const double se = fit->se()[fit->thresholds.size()];
  TestOutcome out;
  out.statistic = "z";
  out.estimate = fit->beta.front();
  out.value = out.estimate / se;
  out.p = side_p(out.value, normal_two_sided(out.value), test.alternative);
  out.estimated = "log odds ratio";
  const double reach = normal_quantile(0.5 + 0.5 * interval_confidence(test)) * se;
  out.ci = one_side_of({out.estimate - reach, out.estimate + reach}, test.alternative);
  count_people(out, rows);
  if (!fit->why_penalised.empty()) out.note = "penalised fit, since a term separates the answers";
  return out;
}

}  // namespace

const char* test_word(TestKind kind) { return test_names[static_cast<std::size_t>(kind)].word; }

const char* test_name(TestKind kind) { return test_names[static_cast<std::size_t>(kind)].name; }

const std::vector<std::string>& test_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> out;
    for (const TestNames& one : test_names) out.emplace_back(one.word);
    return out;
  }();
  return words;
}

TestKind test_of(const std::string& word) {
  const auto& words = test_words();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) throw std::invalid_argument("test_of: use a word of test_words(), not " + word);
  return static_cast<TestKind>(found - words.begin());
}

bool of_groups(TestKind kind) { return kind == TestKind::WelchT || kind == TestKind::StudentT; }

bool of_answers(TestKind kind) {
  return kind == TestKind::LinearMixed || kind == TestKind::CumulativeLinkMixed;
}

const char* alternative_word(Alternative alternative) {
  return alternative_names[static_cast<std::size_t>(alternative)];
}

Alternative alternative_of(const std::string& word) {
  const auto* const found = std::find(alternative_names.begin(), alternative_names.end(), word);
  if (found == alternative_names.end())
    throw std::invalid_argument("alternative_of: use two-sided, less or greater, not " + word);
  return static_cast<Alternative>(found - alternative_names.begin());
}

Result<TestOutcome> run_declared(const DeclaredTest& test, std::span<const ExactMean> a,
                                 std::span<const ExactMean> b) {
  check_margin(test);
  switch (test.kind) {
    case TestKind::PairedT:
      return run_paired_t(test, a, b);
    case TestKind::Wilcoxon:
      return run_wilcoxon(test, a, b);
    case TestKind::SignTest:
      return run_sign_test(test, a, b);
    case TestKind::Tost:
      return run_equivalence(test, a, b);
    case TestKind::WelchT:
    case TestKind::StudentT:
      return run_group_t(test, a, b);
    case TestKind::LinearMixed:
    case TestKind::CumulativeLinkMixed:
      break;
  }
  throw std::invalid_argument("run_declared: a mixed model takes single answers; give AnswerRows");
}

Result<TestOutcome> run_declared(const DeclaredTest& test, const AnswerRows& rows) {
  check_margin(test);
  if (test.kind == TestKind::LinearMixed) return run_linear_mixed(test, rows);
  if (test.kind == TestKind::CumulativeLinkMixed) return run_link_mixed(test, rows);
  throw std::invalid_argument(
      "run_declared: this test takes one value of each participant, not single answers; give lists of "
      "ExactMean");
}

}  // namespace stats
