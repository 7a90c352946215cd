#include "libstudy/power/studies.hpp"
#include "stats/base/progress.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <vector>

namespace study {

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

}  // namespace study
