#pragma once
/// The tests that an analysis plan can declare, in one form: which test, which side, and its result.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/inference/distributions.hpp"
#include "stats/inference/exact_mean.hpp"
#include "stats/ordinal/cumulative_link.hpp"
#include "stats/result.hpp"

namespace stats {

enum class TestKind {
  PairedT,              ///< t test of each participant's difference
  Wilcoxon,             ///< signed ranks of each participant's difference
  SignTest,             ///< exact binomial test of the signs of each participant's difference
  Tost,                 ///< two one-sided t tests of each participant's difference against -+ margin
  WelchT,               ///< t test of two groups of participants, unequal variances
  StudentT,             ///< t test of two groups of participants, equal variances
  LinearMixed,          ///< t test of the linear mixed model of single answers
  CumulativeLinkMixed,  ///< z test of the cumulative-link mixed model of single answers
};

/// The word in plan files: "paired_t", "wilcoxon", "binomial", "tost", "welch_t", "student_t", "mixed",
/// "clmm".
const char* test_word(TestKind kind);
const std::vector<std::string>& test_words();
/// The kind of a word of test_words(); std::invalid_argument for any other word.
TestKind test_of(const std::string& word);
/// The name of the test for display, such as "paired t test".
const char* test_name(TestKind kind);

/// True if the test compares two groups of different participants.
bool of_groups(TestKind kind);
/// True if the test is a model of all single answers.
bool of_answers(TestKind kind);

/// The word of a side: "two-sided", "less", "greater". alternative_of() returns the side of a word;
/// std::invalid_argument for any other word.
const char* alternative_word(Alternative alternative);
Alternative alternative_of(const std::string& word);

/// A test as declared, before there are data.
struct DeclaredTest {
  TestKind kind = TestKind::PairedT;
  Alternative alternative = Alternative::TwoSided;
  /// Tost: the hypothesis is that the difference lies between -margin and margin. A one-sided t test: the
  /// hypothesis of non-inferiority, that the difference is above -margin (Greater) or below margin (Less).
  /// The margin has the unit of the outcome and is above 0.
  std::optional<double> margin = {};
  double confidence = 0.95;  ///< confidence of intervals; the interval of Tost has the confidence 2 *
                             ///< confidence - 1
};

/// Result of a declared test. The estimate is that of a - b.
struct TestOutcome {
  std::string statistic;  ///< "t", "W+", "k" or "z"
  double value = 0;       ///< the statistic; Tost: the t of the larger p
  std::optional<double> df = {};
  double p = 1;
  std::string estimated;  ///< "mean difference", "Hodges-Lehmann shift", "share above", "log odds ratio"
  double estimate = 0;
  std::optional<std::array<double, 2>> ci = {};  ///< interval of the estimate; an end may be infinite
  std::string effect = {};                       ///< name of the effect size; empty if the test has none
  std::optional<double> effect_size = {};
  std::optional<std::array<double, 2>> effect_ci = {};
  int n_a = 0, n_b = 0;  ///< participants used; equal for tests of differences
  bool groups = false;   ///< true if no participant has both conditions
  int n_missing = 0;     ///< participants left out because a value is missing
  std::string note = {};
};

/// Tests one value of each participant. Tests of differences: a[i] and b[i] are of one participant; in a
/// comparison with a constant, every value of `b` is the constant. of_groups(): a and b are different
/// participants. A value is a mean held as sum and count (ExactMean); a sum of NaN marks a missing value.
/// std::invalid_argument: of_answers(), unequal lengths of paired values, a margin that is not above 0, a
/// margin with any test but Tost and one-sided t tests, and Tost without a margin or with a side. Refused
/// where the test is undefined for the data.
Result<TestOutcome> run_declared(const DeclaredTest& test, std::span<const ExactMean> a,
                                 std::span<const ExactMean> b);

/// Single answers for a model. All columns have one length.
struct AnswerRows {
  std::vector<double> answer;
  std::vector<int> participant;
  std::vector<int> condition;    ///< 0: a, 1: b
  std::vector<Predictor> terms;  ///< further fixed terms, such as the levels of other factors
};

/// Fits the model of the test (of_answers()) and tests a against b. Random effects: the participant, and for
/// LinearMixed the participant with the condition. std::invalid_argument for another kind or a margin.
/// Refused where the model cannot be fitted.
Result<TestOutcome> run_declared(const DeclaredTest& test, const AnswerRows& rows);

}  // namespace stats
