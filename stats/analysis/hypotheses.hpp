#pragma once
/// Confirmatory tests of hypotheses about methods. The tests of one claim form a family; the analysis plan's
/// rule (each test at alpha, or each after Holm) decides on the claim. If a paper tested the claim, the
/// result also contains the verdict that the paper's own procedure, without correction for multiple tests,
/// gives on the same data.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stats/analysis/plan.hpp"
#include "stats/analysis/score_table.hpp"
#include "stats/analysis/task2.hpp"
#include "stats/analysis/tipping.hpp"

namespace stats {

enum class HypothesisStatus {
  Supported,        ///< every test of the family holds under the plan's rule
  PartlySupported,  ///< some tests hold after Holm
  NotSupported,     ///< no test holds after Holm
  NotTestable,      ///< the claim needs gaze, which was not tracked in every session
  NoData,           ///< no test could be computed
};
/// The status in words: "supported", "partly supported", ...
const char* status_name(HypothesisStatus status);

struct HypothesisTest {
  std::string label;
  std::string method;         ///< "paired t test", "t test of the mixed model", ...
  std::string score, n_star;  ///< Task 1 (ratings) only: the score's code, the nominal number of particles
  std::string a, b;           ///< methods
  std::size_t n = 0;     ///< Task 1: participants with both methods, or in the mixed model; Task 2: answers
  std::optional<int> k;  ///< Task 2: number of choices of a
  std::optional<double> estimate;  ///< mean difference a - b, or share of choices of a
  std::optional<std::array<double, 2>> ci;
  double ci_confidence = 0.95;
  std::optional<double> margin;
  /// Task 1: the t statistic that p belongs to (of two one-sided tests, that with the larger p), and the
  /// paired effect size, which is empty for the mixed model.
  std::optional<double> t, df, d_z;
  std::optional<double> se;  ///< standard error of the estimate
  std::optional<double> p, p_holm;
  bool holds_alone = false;       ///< p < alpha in the direction claimed
  bool holds_holm = false;        ///< p_holm < alpha in the direction claimed
  bool holds = false;             ///< holds_holm or holds_alone, whichever the plan's rule uses
  bool against = false;           ///< p_holm < alpha in the other direction (two-sided tests)
  std::string reason;             ///< why there is no p, which then counts as 1 in the family
  std::optional<double> paper_p;  ///< p as the claim's paper computes it: two-sided, uncorrected
  bool paper_holds = false;
  /// For claims of Task 2 (choices between two methods) with MethodClaim::larger_families: p of the two-sided
  /// test after Holm over the pairs that the claims of Task 2 compare (five in the ViP-Fluid paper's Fig.
  /// 10), and over all pairs (ten with five methods).
  std::optional<double> p_holm_of_five, p_holm_of_ten;
  /// By how many points missing answers must be worse to change `holds`; set by add_tipping_points().
  std::optional<Result<TippingPoint>> tipping;
};

/// The verdict of the paired tests, reported when the plan decides by the mixed model.
struct PairedVerdict {
  /// Status from the tests alone, even if the status of the hypothesis is NotTestable.
  HypothesisStatus status = HypothesisStatus::NoData;
  int confirmed = 0;
  std::vector<HypothesisTest> tests;
};

struct Hypothesis {
  std::string id;     ///< id of its claim
  std::string title;  ///< the claim in words
  int task = 1;
  HypothesisKind kind = HypothesisKind::Superiority;
  double alpha = 0.05;
  DecisionRule decision = DecisionRule::IntersectionUnion;
  bool one_sided = false;
  std::string rule;
  HypothesisStatus status = HypothesisStatus::NoData;  ///< NotTestable, or else status_if_testable
  HypothesisStatus status_if_testable = HypothesisStatus::NoData;  ///< the verdict of the tests alone
  std::string status_text;                                         ///< the verdict in one sentence
  int confirmed = 0;                                               ///< number of tests that hold
  int confirmed_holm = 0;                                          ///< number of tests that hold after Holm
  /// p of the whole claim: the largest p of its tests (after Holm if the plan decides by Holm); 1 if a test
  /// has no p or its estimate lies in the other direction. Empty if no test has a p.
  std::optional<double> p_claim;
  /// p_claim after Holm over all claims of the plan; set by correct_over_claims().
  std::optional<double> p_claim_of_six;
  std::vector<HypothesisTest> tests;
  std::optional<PairedVerdict> paired;
  std::string paper_rule, paper_text;  ///< empty: the claim has no paper
  bool paper_supported = false;
  std::string paper_published;  ///< the paper's verdict on its own data
};

/// Tests the claims of Task 1 (ratings) within each n_* (nominal number of particles). The plan chooses
/// paired t tests over participants or the mixed model of each score; with the mixed model the paired tests
/// are reported too. The plan also chooses one-sided or two-sided tests. In the two-sided case p of
/// equivalence is twice the larger one-sided p, p of non-inferiority is the two-sided p against its margin,
/// and all intervals have the confidence 1 - alpha. `untestable`: why claims that need gaze cannot be tested;
/// empty if they can. The rule of a claim's paper is always applied to the paired tests.
std::vector<Hypothesis> task1_hypotheses(std::span<const MethodClaim> claims, const ScoreTable& realism,
                                         const ScoreTable& sickness, const AnalysisPlan& plan,
                                         const std::string& untestable);

/// Tipping points of the tests of Task 1: by how many points missing answers must be worse before the plan's
/// decision on the test (`holds`) changes, if the other tests and the standard error of this test stay as
/// they are. Tests of a score that no table of `tables` has are skipped.
void add_tipping_points(std::span<Hypothesis> hypotheses, std::span<const ScoreTable> tables);

/// Tests the claims of Task 2 (choices between two methods) by exact binomial tests. Where
/// PairPreference::shares is set, since people answered a pair more than once, share_test() of each person's
/// share of choices replaces the binomial test. `untestable`: why claims that need gaze cannot be tested.
std::vector<Hypothesis> task2_hypotheses(std::span<const MethodClaim> claims,
                                         std::span<const PairPreference> pairs,
                                         const std::vector<std::string>& methods, const AnalysisPlan& plan,
                                         const std::string& untestable);

/// The hypotheses whose methods a protocol shows, and the reason why each other hypothesis is left out.
struct ShownClaims {
  struct LeftOut {
    std::string id;                     ///< id of one hypothesis, or several ids in short: "A to C"
    std::string reason;                 ///< "the protocol does not show FovFluid"
    std::vector<std::string> ids = {};  ///< ids of all these hypotheses
  };
  std::vector<Hypothesis> claims;
  std::vector<LeftOut> left_out;
};
/// Leaves out each hypothesis with a test of a method that is not among `methods`.
ShownClaims claims_about(std::vector<Hypothesis> all, const std::vector<std::string>& methods);

/// Corrects p_claim by Holm over all claims of the plan, `of` in number; absent or untestable claims count as
/// p = 1. The result is only displayed; the decisions use alpha for each claim.
void correct_over_claims(std::span<Hypothesis> claims, std::size_t of);

/// True if a claim of Task 2 (choices between two methods) compares the methods a and b.
bool compares_pair(std::span<const MethodClaim> claims, const std::string& a, const std::string& b);

}  // namespace stats
