#include "stats/analysis/hypothesis_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/inference/adjust.hpp"

namespace stats {

namespace {

constexpr double no_p = std::numeric_limits<double>::quiet_NaN();

std::string count_text(int part, std::size_t whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

void correct(Hypothesis& out, const std::vector<FamilyTest>& tests) {
  std::vector<double> p;
  for (const FamilyTest& one : tests) p.push_back(one.test.p.value_or(no_p));
  const auto holm = adjust(p, Adjustment::Holm, p.size());
  const bool by_holm = out.decision == DecisionRule::Holm;
  if (holm) out.p_claim = 0;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    out.tests.push_back(tests[i].test);
    HypothesisTest& test = out.tests.back();
    if (holm && test.p) {
      test.p_holm = holm->p[i];
      test.holds_alone = *test.p < out.alpha && tests[i].right;
      test.holds_holm = *test.p_holm < out.alpha && tests[i].right;
      test.against = *test.p_holm < out.alpha && !tests[i].right;
      test.holds = by_holm ? test.holds_holm : test.holds_alone;
    }
    if (holm)
      out.p_claim = std::max(*out.p_claim, !test.p || !tests[i].right ? 1 : by_holm ? *test.p_holm : *test.p);
  }
}

int count_of(const Hypothesis& hypothesis, bool HypothesisTest::*what) {
  return static_cast<int>(std::count_if(hypothesis.tests.begin(), hypothesis.tests.end(),
                                        [&](const HypothesisTest& test) { return test.*what; }));
}

HypothesisStatus status_of(const Hypothesis& hypothesis) {
  if (!hypothesis.p_claim) return HypothesisStatus::NoData;
  if (hypothesis.confirmed == static_cast<int>(hypothesis.tests.size())) return HypothesisStatus::Supported;
  return hypothesis.confirmed_holm > 0 ? HypothesisStatus::PartlySupported : HypothesisStatus::NotSupported;
}

std::string sentence(const Hypothesis& out) {
  const std::size_t n = out.tests.size();
  std::string text =
      count_text(out.confirmed, n) + " " + kind_name(out.kind) + (n == 1 ? " test holds" : " tests hold");
  if (n > 1 && out.decision == DecisionRule::Holm) text += " after Holm";
  if (n > 1 && out.decision == DecisionRule::IntersectionUnion)
    text += fmt::format(" at {:g} each, and the claim needs all; {} after Holm", out.alpha,
                        count_text(out.confirmed_holm, n));
  int refused = 0;
  for (const HypothesisTest& test : out.tests) refused += test.p ? 0 : 1;
  const int against = count_of(out, &HypothesisTest::against);
  if (against > 0) text += "; " + count_text(against, n) + " significant in the other direction";
  if (refused > 0) text += "; " + count_text(refused, n) + " could not be computed and count as p = 1";
  return text + ".";
}

void judge_as_the_paper(Hypothesis& out) {
  const int n = count_of(out, &HypothesisTest::paper_holds);
  out.paper_supported = n == static_cast<int>(out.tests.size());
  out.paper_text =
      count_text(n, out.tests.size()) + (out.tests.size() == 1 ? " test is" : " tests are") +
      " as the paper's rule asks: " +
      (out.paper_supported ? "it would have been confirmed." : "it would not have been confirmed.");
}

}  // namespace

const char* status_name(HypothesisStatus status) {
  switch (status) {
    case HypothesisStatus::Supported:
      return "supported";
    case HypothesisStatus::PartlySupported:
      return "partly supported";
    case HypothesisStatus::NotSupported:
      return "not supported";
    case HypothesisStatus::NotTestable:
      return "not testable";
    case HypothesisStatus::NoData:
      break;
  }
  return "no data";
}

const char* kind_name(HypothesisKind kind) {
  switch (kind) {
    case HypothesisKind::Superiority:
      return "superiority";
    case HypothesisKind::Equivalence:
      return "equivalence";
    case HypothesisKind::NonInferiority:
      return "non-inferiority";
    case HypothesisKind::Preference:
      break;
  }
  return "preference";
}

Family begin_family(const MethodClaim& claim, const AnalysisPlan& plan, const std::string& untestable) {
  Family family{claim, plan, claim.needs_gaze ? untestable : "", {}, {}};
  Hypothesis& out = family.out;
  out.id = claim.id;
  out.title = claim.text;
  out.kind = claim.kind;
  out.task = claim.task;
  out.alpha = plan.alpha;
  out.decision = plan.decision;
  out.one_sided =
      plan.directional == Directional::All || (plan.directional == Directional::Once && claim.once_one_sided);
  if (claim.paper) {
    out.paper_rule = claim.paper->rule;
    out.paper_published = claim.paper->published;
  }
  return family;
}

bool confirmed_as_in_paper(const MethodClaim& claim, bool significant, bool right) {
  if (!claim.paper) return false;
  switch (claim.paper->holds) {
    case PaperHolds::Significant:
      return significant && right;
    case PaperHolds::NotSignificant:
      return !significant;
    case PaperHolds::NotWorse:
      break;
  }
  return !significant || right;
}

std::string rule_text(const Hypothesis& hypothesis, const RuleWords& words, std::size_t tests) {
  const bool by_holm = hypothesis.decision == DecisionRule::Holm;
  return (hypothesis.one_sided ? words.one_sided : words.two_sided) + ", " +
         (tests == 1 ? "significant"
          : by_holm  ? "significant after Holm"
                     : "all significant") +
         (hypothesis.one_sided || words.claim.empty() ? "" : " and " + words.claim);
}

Hypothesis finish(Family family) {
  Hypothesis out = std::move(family.out);
  correct(out, family.tests);
  out.confirmed = count_of(out, &HypothesisTest::holds);
  out.confirmed_holm = count_of(out, &HypothesisTest::holds_holm);
  out.status_if_testable = status_of(out);
  out.status = family.untestable.empty() ? out.status_if_testable : HypothesisStatus::NotTestable;
  out.status_text = sentence(out);
  if (!family.untestable.empty())
    out.status_text =
        "Here " + family.untestable + "; the figures are shown all the same: " + out.status_text;
  if (family.claim.paper) judge_as_the_paper(out);
  return out;
}

ShownClaims claims_about(std::vector<Hypothesis> all, const std::vector<std::string>& methods) {
  ShownClaims out;
  for (Hypothesis& one : all) {
    std::vector<std::string> missing_methods;
    for (const HypothesisTest& test : one.tests) {
      for (const std::string& method : {test.a, test.b}) {
        const bool shown = std::find(methods.begin(), methods.end(), method) != methods.end();
        const bool listed =
            std::find(missing_methods.begin(), missing_methods.end(), method) != missing_methods.end();
        if (!shown && !listed) missing_methods.push_back(method);
      }
    }
    if (missing_methods.empty()) {
      out.claims.push_back(std::move(one));
    } else {
      out.left_out.push_back(
          {one.id,
           fmt::format("the protocol does not show {}", fmt::join(missing_methods, " and ")),
           {one.id}});
    }
  }
  return out;
}

void correct_over_claims(std::span<Hypothesis> claims, std::size_t of) {
  std::vector<double> p;
  for (const Hypothesis& one : claims)
    p.push_back(one.status == HypothesisStatus::NotTestable ? no_p : one.p_claim.value_or(no_p));
  const auto holm = adjust(p, Adjustment::Holm, of);
  for (std::size_t i = 0; holm && i < p.size(); ++i) {
    if (!std::isnan(p[i])) claims[i].p_claim_of_six = holm->p[i];
  }
}

std::vector<std::optional<double>> holm_over_pairs(
    std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
    const std::function<bool(const std::string&, const std::string&)>& chosen) {
  std::vector<double> p(pairs.size(), no_p);
  std::size_t family = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!chosen(methods[static_cast<std::size_t>(pairs[i].a)], methods[static_cast<std::size_t>(pairs[i].b)]))
      continue;
    ++family;
    if (const auto own = pairs[i].p()) p[i] = *own;
  }
  std::vector<std::optional<double>> out(pairs.size());
  const auto holm = adjust(p, Adjustment::Holm, family);
  for (std::size_t i = 0; holm && i < pairs.size(); ++i) {
    if (!std::isnan(p[i])) out[i] = holm->p[i];
  }
  return out;
}

}  // namespace stats
