#include "libstudy/power/task_counts.hpp"

#include <cmath>

namespace study {

namespace {

constexpr double estimate_unit = 1e-9;

TestCount count_test(const stats::HypothesisTest& test) {
  TestCount out;
  out.holds = test.holds_holm ? 1 : 0;
  out.uncorrected = test.holds_alone ? 1 : 0;
  out.against = test.against ? 1 : 0;
  out.refused = test.p ? 0 : 1;
  out.participants_least = out.participants_most = static_cast<int>(test.n);
  if (test.estimate) {
    out.estimates = 1;
    out.estimate_units = std::llround(*test.estimate / estimate_unit);
  }
  return out;
}

}  // namespace

void TestCount::add(const TestCount& other) {
  holds += other.holds;
  uncorrected += other.uncorrected;
  against += other.against;
  refused += other.refused;
  estimates += other.estimates;
  estimate_units += other.estimate_units;
  participants_least = std::min(participants_least, other.participants_least);
  participants_most = std::max(participants_most, other.participants_most);
}

double TestCount::mean_estimate() const {
  if (estimates == 0) return 0;
  return static_cast<double>(estimate_units) * estimate_unit / static_cast<double>(estimates);
}

void HypothesisCount::add(const HypothesisCount& other) {
  supported += other.supported;
  any += other.any;
  any_false += other.any_false;
  paper += other.paper;
  for (std::size_t i = 0; i < tests.size(); ++i) tests[i].add(other.tests.at(i));
}

HypothesisCount count_hypothesis(const stats::Hypothesis& hypothesis, const std::vector<bool>& claims) {
  HypothesisCount out;
  out.supported = hypothesis.status == stats::HypothesisStatus::Supported ? 1 : 0;
  out.any = hypothesis.confirmed_holm > 0 ? 1 : 0;
  out.paper = hypothesis.paper_supported ? 1 : 0;
  for (std::size_t i = 0; i < hypothesis.tests.size(); ++i) {
    out.tests.push_back(count_test(hypothesis.tests[i]));
    if (hypothesis.tests[i].holds_holm && !claims[i]) out.any_false = 1;
  }
  return out;
}

void add(TaskCounts& sum, const TaskCounts& other) {
  for (std::size_t n = 0; n < sum.size(); ++n)
    for (std::size_t i = 0; i < sum[n].size(); ++i) sum[n][i].add(other.at(n).at(i));
}

}  // namespace study
