#include "stats/analysis/hypothesis_family.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/inference/adjust.hpp"

namespace stats {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

std::string count_text(int part, std::size_t whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

void correct(Hypothesis& out, const std::vector<FamilyTest>& tests) {
  std::vector<double> p;
  for (const FamilyTest& one : tests) p.push_back(one.test.p.value_or(missing));
  const auto holm = adjust(p, Adjustment::Holm, p.size());
  for (std::size_t i = 0; i < tests.size(); ++i) {
    out.tests.push_back(tests[i].test);
    HypothesisTest& test = out.tests.back();
    if (!holm || !test.p) continue;
    test.p_holm = holm->p[i];
    test.holds = *test.p_holm < out.alpha && tests[i].right;
    test.against = *test.p_holm < out.alpha && !tests[i].right;
  }
}

HypothesisStatus status_of(const Hypothesis& hypothesis) {
  const auto& tests = hypothesis.tests;
  if (std::none_of(tests.begin(), tests.end(), [](const HypothesisTest& test) { return test.p.has_value(); }))
    return HypothesisStatus::NoData;
  if (hypothesis.confirmed == static_cast<int>(tests.size())) return HypothesisStatus::Supported;
  return hypothesis.confirmed > 0 ? HypothesisStatus::PartlySupported : HypothesisStatus::NotSupported;
}

std::string sentence(const Hypothesis& out) {
  const std::size_t n = out.tests.size();
  std::string text = count_text(out.confirmed, n) + " " + kind_name(out.kind) +
                     (n == 1 ? " test holds" : " tests hold after Holm");
  int against = 0, refused = 0;
  for (const HypothesisTest& test : out.tests) {
    against += test.against ? 1 : 0;
    refused += test.p ? 0 : 1;
  }
  if (against > 0) text += "; " + count_text(against, n) + " significant in the other direction";
  if (refused > 0) text += "; " + count_text(refused, n) + " could not be computed and count as p = 1";
  return text + ".";
}

void judge_as_the_paper(Hypothesis& out) {
  const auto n = static_cast<int>(std::count_if(out.tests.begin(), out.tests.end(),
                                                [](const HypothesisTest& test) { return test.paper_holds; }));
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

Hypothesis finish(Family family) {
  Hypothesis out = std::move(family.out);
  out.alpha = family.plan.alpha;
  correct(out, family.tests);
  out.confirmed = static_cast<int>(std::count_if(out.tests.begin(), out.tests.end(),
                                                 [](const HypothesisTest& test) { return test.holds; }));
  out.status_if_testable = status_of(out);
  out.status = family.untestable.empty() ? out.status_if_testable : HypothesisStatus::NotTestable;
  out.status_text = sentence(out);
  if (!family.untestable.empty())
    out.status_text =
        "Here " + family.untestable + "; the figures are shown all the same: " + out.status_text;
  judge_as_the_paper(out);
  return out;
}

std::vector<std::optional<double>> holm_over_pairs(
    std::span<const PairPreference> pairs, const std::vector<std::string>& methods,
    const std::function<bool(const std::string&, const std::string&)>& chosen) {
  std::vector<double> p(pairs.size(), missing);
  std::size_t family = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!chosen(methods[static_cast<std::size_t>(pairs[i].a)], methods[static_cast<std::size_t>(pairs[i].b)]))
      continue;
    ++family;
    if (pairs[i].test) p[i] = pairs[i].test->p;
  }
  std::vector<std::optional<double>> out(pairs.size());
  const auto holm = adjust(p, Adjustment::Holm, family);
  for (std::size_t i = 0; holm && i < pairs.size(); ++i) {
    if (!std::isnan(p[i])) out[i] = holm->p[i];
  }
  return out;
}

}  // namespace stats
