/// Recovery of the observer's truth by vip-stats, and coverage of its intervals.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

#include "libstudy/analysis/task_data.hpp"
#include "stats/ptpe/pilot.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace {

struct Truth {
  double a, b;
};

void PrintTo(const Truth& truth, std::ostream* out) { *out << "a = " << truth.a << ", b = " << truth.b; }

struct Recovered {
  int studies = 0, unfitted = 0, holds_a = 0, holds_b = 0;
  double mean_a = 0, mean_b = 0, sd_a = 0, sd_b = 0, half_a = 0, half_b = 0;
};

std::string observer(const Truth& truth) {
  return "ptpe:a=" + std::to_string(truth.a) + ",b=" + std::to_string(truth.b);
}

/// Means, standard deviations and coverage over simulated studies of 16 participants, seeds 1, 2, 3 ...
Recovered recover(const Truth& truth, int studies, int resamples) {
  Recovered r{studies};
  for (int study = 0; study < studies; ++study) {
    const auto pilot =
        testing_pilot::simulated_pilot(observer(truth), 16, static_cast<std::uint64_t>(study) + 1);
    const auto data = study::select_task({{pilot}, 0}, {study::TaskKind::Pilot, {}, {}});
    const auto estimate = stats::estimate_pilot(stats::PilotTable(data->ratings), stats::PilotMean::Harmonic,
                                                4, {resamples, static_cast<std::uint64_t>(study) + 1, 0.95});
    if (!estimate.spread) {
      ++r.unfitted;
      continue;
    }
    const auto &a_ci = estimate.spread->a_ci, &b_ci = estimate.spread->b_ci;
    r.holds_a += a_ci[0] <= truth.a && truth.a <= a_ci[1];
    r.holds_b += b_ci[0] <= truth.b && truth.b <= b_ci[1];
    r.mean_a += estimate.fit->a;
    r.mean_b += estimate.fit->b;
    r.sd_a += estimate.fit->a * estimate.fit->a;
    r.sd_b += estimate.fit->b * estimate.fit->b;
    r.half_a += (a_ci[1] - a_ci[0]) / 2;
    r.half_b += (b_ci[1] - b_ci[0]) / 2;
  }
  const double n = studies - r.unfitted;
  for (double* sum : {&r.mean_a, &r.mean_b, &r.sd_a, &r.sd_b, &r.half_a, &r.half_b}) *sum /= n;
  r.sd_a = std::sqrt(r.sd_a - r.mean_a * r.mean_a);
  r.sd_b = std::sqrt(r.sd_b - r.mean_b * r.mean_b);
  return r;
}

TEST(PilotRecovery, IntervalsHoldTheDemosTruth) {
  constexpr int studies = 40;
  const Truth truth{24, 0.02};
  const auto r = recover(truth, studies, 300);
  EXPECT_EQ(r.unfitted, 0);
  // 95 % of 40 intervals, 38, should cover the truth, with a standard deviation of 1.4.
  EXPECT_GE(r.holds_a, 33);
  EXPECT_GE(r.holds_b, 33);
  // The bias must be below the standard deviation of the estimates. Half widths are near 1.96 to 2.6 standard
  // deviations.
  EXPECT_NEAR(r.mean_a, truth.a, r.sd_a);
  EXPECT_NEAR(r.mean_b, truth.b, r.sd_b);
  EXPECT_LT(r.half_a, 3.2 * r.sd_a);
  EXPECT_LT(r.half_b, 3.2 * r.sd_b);
}

class PilotRecoverySlow : public testing::TestWithParam<Truth> {};

TEST_P(PilotRecoverySlow, IntervalsCoverBetween85And99Percent) {
  constexpr int studies = 200;
  const auto truth = GetParam();
  const auto r = recover(truth, studies, 2000);
  std::printf(
      "a = %g, b = %g: %d studies, %d without a fit; intervals hold a in %.1f %%, b in %.1f %%; a %.2f (sd "
      "%.2f), "
      "b %.4f (sd %.4f); mean half widths %.2f, %.4f\n",
      truth.a, truth.b, studies, r.unfitted, 100.0 * r.holds_a / studies, 100.0 * r.holds_b / studies,
      r.mean_a, r.sd_a, r.mean_b, r.sd_b, r.half_a, r.half_b);
  EXPECT_EQ(r.unfitted, 0);
  for (const int holds : {r.holds_a, r.holds_b}) {
    EXPECT_GE(holds, 0.85 * studies);
    EXPECT_LE(holds, 0.99 * studies);
  }
}

// The demo's truth; the truth of the command examples, whose curve leaves the frame rates shown; and four
// others.
INSTANTIATE_TEST_SUITE_P(Truths, PilotRecoverySlow,
                         testing::Values(Truth{24, 0.02}, Truth{31, 0.035}, Truth{20, 0.03}, Truth{28, 0.01},
                                         Truth{35, 0.015}, Truth{27, 0.028}));

}  // namespace
