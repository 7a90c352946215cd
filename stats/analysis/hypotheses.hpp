#pragma once
/// H1 to H6 of the paper (5.3.1) as confirmatory tests: each a claim with a family of its own, decided by the
/// plan's rule. What the paper's own, uncorrected procedure says of the same data stands beside.

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
  Supported,        ///< every test of the family holds by the plan's rule
  PartlySupported,  ///< some do after Holm
  NotSupported,     ///< none does after Holm
  NotTestable,      ///< the study cannot tell, whatever the figures are
  NoData,           ///< no test could be computed
};
/// "supported", "partly supported", ...
const char* status_name(HypothesisStatus status);

enum class HypothesisKind { Superiority, Equivalence, NonInferiority, Preference };
/// "superiority", "equivalence", "non-inferiority", "preference".
const char* kind_name(HypothesisKind kind);

struct HypothesisTest {
  std::string label;
  std::string method;              ///< "paired t test", "t test of the mixed model", ...
  std::string score, n_star;       ///< of Task 1
  std::string a, b;                ///< methods
  std::size_t n = 0;               ///< participants with both, or of the mixed model; answers
  std::optional<int> k;            ///< a chosen (Task 2)
  std::optional<double> estimate;  ///< mean difference a - b, or share of a
  std::optional<std::array<double, 2>> ci;
  double ci_confidence = 0.95;
  std::optional<double> margin;
  /// Task 1: statistic to which p belongs (of two one-sided tests the one nearer to zero), and the paired
  /// effect size, which the mixed model does not have.
  std::optional<double> t, df, d_z;
  std::optional<double> se;  ///< of the estimate
  std::optional<double> p, p_holm;
  bool holds_alone = false;       ///< p < alpha in the direction claimed
  bool holds_holm = false;        ///< p_holm < alpha in the direction claimed
  bool holds = false;             ///< that of the two by which the plan decides
  bool against = false;           ///< p_holm < alpha in the other direction (two-sided tests)
  std::string reason;             ///< why there is no p; it then counts as 1 in the family
  std::optional<double> paper_p;  ///< two-sided, uncorrected
  bool paper_holds = false;
  /// Of a two-sided test of preference: what Holm makes of p over the five pairs of the paper's Fig. 10 and
  /// over all ten. The choice of the family decides, so all are shown.
  std::optional<double> p_holm_of_five, p_holm_of_ten;
  std::optional<Result<TippingPoint>> tipping;  ///< of `holds`; see add_tipping_points
};

/// What the paired tests say where the plan decides by the mixed model.
struct PairedVerdict {
  HypothesisStatus status = HypothesisStatus::NoData;  ///< were the hypothesis testable
  int confirmed = 0;
  std::vector<HypothesisTest> tests;
};

struct Hypothesis {
  std::string id;     ///< "H1"
  std::string title;  ///< the paper's words
  int task = 1;
  HypothesisKind kind = HypothesisKind::Superiority;
  double alpha = 0.05;
  DecisionRule decision = DecisionRule::IntersectionUnion;
  bool one_sided = false;
  std::string rule;
  HypothesisStatus status = HypothesisStatus::NoData;
  HypothesisStatus status_if_testable = HypothesisStatus::NoData;
  std::string status_text;  ///< one sentence
  int confirmed = 0;        ///< tests that hold
  int confirmed_holm = 0;   ///< tests that hold after Holm
  /// Of the whole claim: the largest p of its tests (after Holm where that decides), 1 where one is refused
  /// or points the other way. Empty without any test.
  std::optional<double> p_claim;
  std::optional<double> p_claim_of_six;  ///< see correct_over_claims
  std::vector<HypothesisTest> tests;
  std::optional<PairedVerdict> paired;
  std::string paper_rule, paper_text;
  bool paper_supported = false;
  std::string paper_published;  ///< what the paper said of its own data
};

/// H1 to H3. `untestable`: why H1 cannot be tested, such as gaze that was not tracked; empty: it can.
/// Within each n_*, by paired t tests over participants, or by the mixed model of each score with the paired
/// tests beside. Two-sided or one-sided as the plan says. Two-sided, H2 has twice the larger one-sided p, H3
/// the two-sided p against its margin, and both the interval of 1 - alpha. What the paper's rule says is of
/// the paired tests.
std::vector<Hypothesis> task1_hypotheses(const ScoreTable& realism, const ScoreTable& sickness,
                                         const AnalysisPlan& plan, const std::string& untestable);

/// Tipping points of the tests of H1 to H3: by how many points missing answers must be worse before the
/// plan's decision on the test (`holds`) changes, the other tests and the error of this one being as they
/// are. `tables`: those that the tests were made of, among others.
void add_tipping_points(std::span<Hypothesis> hypotheses, std::span<const ScoreTable> tables);

/// H4 to H6 by exact binomial tests. `untestable`: why H5 cannot be tested.
std::vector<Hypothesis> task2_hypotheses(std::span<const PairPreference> pairs,
                                         const std::vector<std::string>& methods, const AnalysisPlan& plan,
                                         const std::string& untestable);

/// Hypotheses about methods that a protocol shows, and why each other one is not tested.
struct ShownClaims {
  struct LeftOut {
    std::string id;      ///< "H1"
    std::string reason;  ///< "the protocol does not show FovFluid"
  };
  std::vector<Hypothesis> claims;
  std::vector<LeftOut> left_out;
};
/// A hypothesis of which any test names a method that is not among `methods` is left out.
ShownClaims claims_about(std::vector<Hypothesis> all, const std::vector<std::string>& methods);

/// Holm over the claims H1 to H6 themselves, those that are absent or not testable as p = 1: shown beside the
/// decisions, which keep to alpha for each claim.
void correct_over_claims(std::span<Hypothesis> claims);

/// The pairs in the paper's Fig. 10.
bool in_paper_figure_10(const std::string& a, const std::string& b);

}  // namespace stats
