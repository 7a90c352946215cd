#include "libstudy/power/studies.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <vector>

#include "stats/base/progress.hpp"

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

void for_each_study(StudyRange studies, const std::string& label, const std::function<void(int)>& simulate) {
  base::Progress progress(label, static_cast<std::size_t>(studies.count));
  std::atomic<int> done = 0;
  std::atomic<bool> failed = false;
  std::exception_ptr failure;
  std::mutex guard;
#pragma omp parallel for schedule(dynamic, 1)
  for (int study = studies.first; study < studies.first + studies.count; ++study) {
    if (failed) continue;
    try {
      simulate(study);
    } catch (...) {
      const std::lock_guard lock(guard);
      if (!failed.exchange(true)) failure = std::current_exception();
    }
    const int so_far = ++done;
    if (omp_get_thread_num() == 0) progress.update(static_cast<std::size_t>(so_far));
  }
  if (failure) std::rethrow_exception(failure);
}

Estimated share_of(std::int64_t k, int n) {
  const double p = static_cast<double>(k + 1) / (n + 2);
  return {static_cast<double>(k) / n, std::sqrt(p * (1 - p) / n)};
}

Estimated mean_of(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double x : values) mean += x / n;
  for (const double x : values) squares += (x - mean) * (x - mean);
  return {mean, std::sqrt(squares / (n - 1) / n)};
}

Estimated quantile_of(std::span<const double> values, double share) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());
  const auto at = [&](double rank) {
    const double place = std::clamp(rank, 0.0, n - 1);
    const auto low = static_cast<std::size_t>(place);
    const auto high = std::min(low + 1, sorted.size() - 1);
    return std::lerp(sorted[low], sorted[high], place - static_cast<double>(low));
  };
  const double rank = share * (n - 1), step = std::sqrt(n * share * (1 - share));
  return {at(rank), (at(rank + step) - at(rank - step)) / 2};
}

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
