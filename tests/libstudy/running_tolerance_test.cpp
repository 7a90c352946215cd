#include "libstudy/pacing/running_tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace study {
namespace {

TEST(RunningTolerance, IsTauOfTheThirtyIntervalsBeforeTheFrame) {
  const stats::PtpeModel model{24, 0.02};
  RunningTolerance tolerance(model);
  std::int64_t now = 5'000'000'000;
  EXPECT_EQ(tolerance.next(now), 0);
  std::vector<double> known;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t interval = 20'000'000 + 1'000'000 * (i * i % 17);
    now += interval;
    const double tau = tolerance.next(now);
    if (known.empty()) {
      EXPECT_EQ(tau, 0);
    } else {
      const std::size_t n = std::min<std::size_t>(30, known.size());
      const auto fps = stats::fps_moments(std::span(known).last(n));
      EXPECT_NEAR(tau, fps.mean - 24 * std::exp(0.02 * fps.sd), 1e-9) << i;
    }
    known.push_back(1e-9 * static_cast<double>(interval));
  }
}

TEST(RunningTolerance, LeavesOutAnIntervalThatIsNotPositive) {
  RunningTolerance tolerance({24, 0.02});
  tolerance.next(0);
  tolerance.next(50'000'000);
  tolerance.next(50'000'000);
  tolerance.next(100'000'000);
  EXPECT_NEAR(tolerance.next(150'000'000), 20 - 24, 1e-9);
}

}  // namespace
}  // namespace study
