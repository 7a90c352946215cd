#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/hold_search.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/fps_window.hpp"

namespace {

using study::Feasibility;
using study::FpsSetting;
using study::PacingRules;

std::vector<FpsSetting> pilot_settings() {
  std::vector<FpsSetting> settings;
  for (const auto& cell : study::read_protocol(base::resource("protocols/ptpe_pilot.toml")).design.cells)
    settings.push_back(cell.setting);
  return settings;
}

double sd_tolerance(const FpsSetting& setting) { return std::max(0.02 * setting.sd, 0.25); }

/// The longest interval of the setting before rounding to refresh periods, in periods, rounded up.
int hold_bound(const FpsSetting& setting, double refresh_hz) {
  const double slowest = study::exact_rates(setting, {}).front();
  return static_cast<int>(std::ceil(refresh_hz / slowest - 1e-9));
}

/// Brute force, independent of the search: dynamic programming over frames and refresh periods. A hold k is
/// the number of periods for which a frame is shown. Finds the least or greatest sum of (refresh_hz / k -
/// c)^2 over all lists of n holds of 1 to `longest` periods that take `total` periods. Returns this sum / n,
/// the extreme of variance + (arithmetic mean - c)^2.
double extreme_square(int n, int total, int longest, double refresh_hz, double c, bool largest) {
  const double worst = largest ? -1 : std::numeric_limits<double>::infinity();
  const auto spare = static_cast<std::size_t>(total - n);  // periods beyond one for each frame
  std::vector<double> best(spare + 1, worst), next;
  best[0] = 0;
  for (int frame = 0; frame < n; ++frame) {
    next.assign(spare + 1, worst);
    for (int extra = 0; extra < longest && extra <= static_cast<int>(spare); ++extra) {
      const double rate = refresh_hz / (1 + extra);
      const double term = (rate - c) * (rate - c);
      for (std::size_t used = 0; used + static_cast<std::size_t>(extra) <= spare; ++used) {
        if (best[used] == worst) continue;
        double& slot = next[used + static_cast<std::size_t>(extra)];
        slot = largest ? std::max(slot, best[used] + term) : std::min(slot, best[used] + term);
      }
    }
    best.swap(next);
  }
  return best[spare] / n;
}

/// True if brute force rules out every list of holds for the setting. extreme_square() gives the least and
/// the greatest variance + (mean - c)^2, here for each c of a grid. The least variance is at least the
/// smallest of the least values minus (spacing / 2)^2. The greatest variance is at most the smallest of the
/// greatest values.
bool ruled_out(const FpsSetting& setting, double refresh_hz) {
  const int n = static_cast<int>(setting.mean * setting.duration_s);
  const double periods = refresh_hz * setting.duration_s;
  const int longest = hold_bound(setting, refresh_hz);
  const double top = setting.sd + sd_tolerance(setting);
  const double floor = std::max(0.0, setting.sd - sd_tolerance(setting));
  // The arithmetic mean of the rates f exceeds their harmonic mean by a limited share: mean(f) / harmonic
  // mean - 1 = -cov(f, 1/f) <= sd(f) sd(1/f). sd(1/f) is at most half the range of 1/f.
  const double reach = setting.mean * (1 + top * (longest - 1) / (2 * refresh_hz));
  const double spacing = 0.2;
  double least = std::numeric_limits<double>::infinity(), most = least;
  for (double c = setting.mean; c <= std::min(reach, refresh_hz) + spacing; c += spacing) {
    least = std::min(least, extreme_square(n, static_cast<int>(periods), longest, refresh_hz, c, false));
    if (floor > 0)
      most = std::min(most, extreme_square(n, static_cast<int>(periods), longest, refresh_hz, c, true));
  }
  return least - spacing * spacing / 4 > top * top || most < floor * floor;
}

/// Checks that the list of holds has the setting's duration, number of frames, mean and SD, with no hold
/// above the bounds.
void expect_exact_list(const FpsSetting& setting, const study::RefreshVerdict& verdict, double refresh_hz) {
  ASSERT_EQ(verdict.holds.size(), static_cast<std::size_t>(setting.mean * setting.duration_s));
  EXPECT_EQ(std::accumulate(verdict.holds.begin(), verdict.holds.end(), 0), refresh_hz * setting.duration_s);
  const auto [shortest, longest] = std::minmax_element(verdict.holds.begin(), verdict.holds.end());
  EXPECT_GE(*shortest, 1);
  EXPECT_LE(*longest, hold_bound(setting, refresh_hz));
  EXPECT_EQ(*longest, verdict.longest_hold);
  EXPECT_LE(*longest / refresh_hz, 0.250 + 1e-9);
  std::vector<double> intervals_s;
  for (const int hold : verdict.holds) intervals_s.push_back(hold / refresh_hz);
  const auto moments = stats::fps_moments(intervals_s);
  EXPECT_NEAR(moments.mean, setting.mean, 1e-9 * setting.mean);
  EXPECT_LE(std::abs(moments.sd - setting.sd), sd_tolerance(setting));
  EXPECT_NEAR(verdict.sd, moments.sd, 1e-6);
}

struct Count {
  double refresh_hz;
  int exact;
};

class PilotOnRefresh : public testing::TestWithParam<Count> {};

// A setting is exact if a list of holds (refresh periods for which each frame is shown) has its mean and SD.
// Such a list proves it; any other setting is disproved by brute force. At 72 Hz the setting (50, 15), mean
// and SD in frames/s, would be exact if fractions of frames were possible, with 31.43 of 500 frames held for
// 8 periods. With whole frames the least SD is 15.35 frames/s, above the bound of 15.3.
TEST_P(PilotOnRefresh, HasThisManyExactSettings) {
  const auto [refresh_hz, expected] = GetParam();
  int exact = 0;
  for (const auto& setting : pilot_settings()) {
    SCOPED_TRACE(study::setting_name(setting));
    const auto verdict = study::quantise(setting, {}, refresh_hz, 3);
    if (verdict.feasibility == Feasibility::Exact) {
      ++exact;
      expect_exact_list(setting, verdict, refresh_hz);
      EXPECT_EQ(verdict.reason, "");
    } else {
      EXPECT_TRUE(ruled_out(setting, refresh_hz));
      EXPECT_NE(verdict.reason, "");
    }
  }
  EXPECT_EQ(exact, expected);
}

INSTANTIATE_TEST_SUITE_P(Rates, PilotOnRefresh,
                         testing::Values(Count{60, 12}, Count{72, 10}, Count{90, 14}, Count{120, 19},
                                         Count{144, 14}, Count{200, 20}, Count{240, 20}, Count{360, 20},
                                         Count{600, 21}),
                         [](const auto& rate) {
                           return std::to_string(static_cast<int>(rate.param.refresh_hz)) + "Hz";
                         });

TEST(Quantise, BruteForceRulesOutNothingThatExists) {
  for (const FpsSetting& setting : {FpsSetting{30, 10, 10}, {10, 5, 10}, {50, 20, 10}}) {
    ASSERT_EQ(study::quantise(setting, {}, 90, 1).feasibility, Feasibility::Exact);
    EXPECT_FALSE(ruled_out(setting, 90));
  }
}

TEST(Quantise, BoundsHoldWhatTheBruteForceFinds) {
  // The bounds are for any distribution of holds (refresh periods per frame), also with fractions of frames.
  // So the SD of every list of holds of whole frames must lie within them.
  study::HoldTarget target;
  target.refresh_hz = 60;
  target.longest = 5;
  target.mean = 24;  // frames last 2.5 periods on average
  const auto bounds = study::sd_bounds(target);
  double least = 1e9, most = 1e9;
  for (double c = 20; c <= 60; c += 0.05) {
    least = std::min(least, extreme_square(40, 100, 5, 60, c, false));
    most = std::min(most, extreme_square(40, 100, 5, 60, c, true));
  }
  EXPECT_NEAR(bounds.low, 5, 1e-9);  // half of the frames at 30, half at 20 frames/s
  EXPECT_NEAR(std::sqrt(least), bounds.low, 0.01);
  EXPECT_LE(std::sqrt(most), bounds.high + 0.01);
  EXPECT_GE(std::sqrt(most), bounds.high - 0.5);
  target.mean = 61;
  const auto none = study::sd_bounds(target);
  EXPECT_GT(none.low, none.high);
}

TEST(Quantise, ComesNearerToTheTargetOnAFinerRefresh) {
  const auto verdict = study::quantise({20, 10, 10}, {}, 600, 1);
  ASSERT_EQ(verdict.feasibility, Feasibility::Exact);
  EXPECT_LT(verdict.distance, 0.5);
  const auto coarse = study::quantise({20, 10, 10}, {}, 90, 1);
  EXPECT_GT(coarse.distance, verdict.distance);
}

TEST(Quantise, SameSeedSameOrderAndSameHolds) {
  const FpsSetting setting{30, 10, 10};
  auto one = study::quantise(setting, {}, 120, 1).holds;
  auto two = study::quantise(setting, {}, 120, 2).holds;
  EXPECT_EQ(one, study::quantise(setting, {}, 120, 1).holds);
  EXPECT_NE(one, two);
  std::sort(one.begin(), one.end());
  std::sort(two.begin(), two.end());
  EXPECT_EQ(one, two);
}

TEST(Quantise, ApproximateKeepsTheMeanAndTheBound) {
  const FpsSetting setting{50, 5, 10};
  const auto verdict = study::quantise(setting, {}, 90, 1);
  EXPECT_EQ(verdict.feasibility, Feasibility::Approximate);
  EXPECT_NEAR(verdict.mean, 50, 0.25);
  // At 90 Hz, holds of one and of two periods have the least SD of any mean between 45 and 90 frames/s.
  const double single = 2 - 90 / verdict.mean;  // share of the frames held for one period
  EXPECT_NEAR(verdict.sd, 45 * std::sqrt(single * (1 - single)), 1e-6);
  EXPECT_LE(verdict.longest_hold, hold_bound(setting, 90));
  EXPECT_THAT(verdict.reason, testing::HasSubstr("forces an sd of 18"));
}

TEST(Quantise, ReasonNamesTheMomentsThatMissAndNoOther) {
  for (const auto& cell : study::read_protocol(base::resource("protocols/task1.toml")).design.cells) {
    SCOPED_TRACE(study::setting_name(cell.setting));
    const auto verdict = study::quantise(cell.setting, {}, 60, 1);
    ASSERT_EQ(verdict.feasibility, Feasibility::Approximate);
    const auto named = [&](const char* pattern, double got, double wished) {
      char text[80];
      std::snprintf(text, sizeof text, pattern, got, wished);
      return verdict.reason.find(text) != std::string::npos;
    };
    EXPECT_EQ(named("mean %.6g for %g (", verdict.mean, cell.setting.mean),
              std::abs(verdict.mean / cell.setting.mean - 1) > 1e-9)
        << verdict.reason;
    EXPECT_EQ(named("sd %.4g for %g (", verdict.sd, cell.setting.sd),
              std::abs(verdict.sd - cell.setting.sd) > sd_tolerance(cell.setting))
        << verdict.reason;
  }
}

TEST(Quantise, UnreachableSaysWhy) {
  const auto fast = study::quantise({100, 5, 10}, {}, 90, 1);
  EXPECT_EQ(fast.feasibility, Feasibility::Unreachable);
  EXPECT_TRUE(fast.holds.empty());
  EXPECT_THAT(fast.reason, testing::HasSubstr("this mean"));
  PacingRules capped;
  capped.fps_max_is_refresh = true;
  const auto no_schedule = study::quantise({50, 20, 10}, capped, 60, 1);
  EXPECT_EQ(no_schedule.feasibility, Feasibility::Unreachable);
  EXPECT_THAT(no_schedule.reason, testing::HasSubstr("(50, 20)"));
  EXPECT_THROW(study::quantise({50, 20, 10}, {}, 0, 1), base::Error);
}

TEST(Quantise, KeepsTheUpperCutAndTheLongestInterval) {
  PacingRules rules;
  rules.fps_max = 46;
  rules.max_interval_ms = 100;
  const auto verdict = study::quantise({30, 5, 10}, rules, 90, 1);
  ASSERT_FALSE(verdict.holds.empty());
  const auto [shortest, longest] = std::minmax_element(verdict.holds.begin(), verdict.holds.end());
  EXPECT_GE(*shortest, 2);
  EXPECT_LE(*longest, 9);
}

TEST(Quantise, ArithmeticMeanIsMetWhereItIsCalledExact) {
  PacingRules rules;
  rules.mean = study::FpsMean::Arithmetic;
  int exact = 0;
  for (const auto& setting : pilot_settings()) {
    const auto verdict = study::quantise(setting, rules, 240, 1);
    if (verdict.feasibility != Feasibility::Exact) continue;
    ++exact;
    std::vector<double> intervals_s;
    for (const int hold : verdict.holds) intervals_s.push_back(hold / 240.0);
    const auto moments = stats::fps_moments(intervals_s);
    EXPECT_NEAR(moments.mean_arithmetic, setting.mean, 1e-4 * setting.mean);
    EXPECT_LE(std::abs(moments.sd - setting.sd), sd_tolerance(setting));
  }
  EXPECT_GE(exact, 19);
}

// The search finds lists of eight holds with the means 49.5 and 50.5, which miss 50 frames/s equally.
TEST(HoldSearch, OfListsThatMissTheMeanEquallyTheOneWithTheBetterSdIsReturned) {
  study::HoldTarget target;
  target.rates.assign(8, 50);
  target.refresh_hz = 72;
  target.longest = 18;
  target.mean_kind = study::FpsMean::Arithmetic;
  target.mean = 50;
  target.mean_tolerance = 0.25;
  target.sd = 5;
  target.sd_tolerance = 0.25;
  const auto found = study::search_holds(target, 0);
  EXPECT_LE(std::abs(found.mean - 50), 0.5 + 1e-9);
  EXPECT_LT(found.sd, 18) << "a list with frames of 18 periods has 29";
  const double mean_miss = std::max(0.0, std::abs(found.mean - 50) - 0.25);
  EXPECT_NEAR(found.excess, mean_miss + found.sd - 5 - 0.25, 1e-9) << "without a weight";
}

TEST(ScheduleOfHolds, KeepsDeadlinesOnTheRefresh) {
  const auto schedule = study::schedule_of_holds({1, 2, 3}, 90);
  EXPECT_DOUBLE_EQ(schedule.intervals_s[1], 2.0 / 90);
  EXPECT_EQ(schedule.intervals_ns, (std::vector<std::int64_t>{11111111, 22222222, 33333334}));
}

}  // namespace
