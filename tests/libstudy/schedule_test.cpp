#include "libstudy/pacing/schedule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libstudy/pacing/exact_rates.hpp"
#include "libstudy/pacing/frame_order.hpp"
#include "libstudy/pacing/truncated_normal.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/fps_window.hpp"
#include "stats/root.hpp"

namespace {

using study::FpsMean;
using study::FpsSetting;
using study::PacingRules;

std::vector<FpsSetting> pilot_settings() {
  std::vector<FpsSetting> settings;
  for (const auto& cell : study::read_protocol(base::resource("protocols/ptpe_pilot.toml")).design.cells)
    settings.push_back(cell.setting);
  return settings;
}

PacingRules rules_with(FpsMean mean) {
  PacingRules rules;
  rules.mean = mean;
  return rules;
}

double mean_of(const stats::FpsMoments& moments, FpsMean mean) {
  return mean == FpsMean::Harmonic ? moments.mean : moments.mean_arithmetic;
}

std::vector<double> seconds(const std::vector<std::int64_t>& intervals_ns) {
  std::vector<double> out;
  for (const auto ns : intervals_ns) out.push_back(1e-9 * static_cast<double>(ns));
  return out;
}

std::vector<double> rates_of(const study::Schedule& schedule) {
  std::vector<double> rates;
  for (const double dt : schedule.intervals_s) rates.push_back(1 / dt);
  return rates;
}

class PilotSchedules : public testing::TestWithParam<FpsMean> {};

TEST_P(PilotSchedules, MeetBothMomentsWithinTheCuts) {
  const auto rules = rules_with(GetParam());
  for (const auto& setting : pilot_settings()) {
    SCOPED_TRACE(study::setting_name(setting));
    const auto schedule = study::compile_schedule(setting, rules, 7);
    ASSERT_EQ(schedule.intervals_s.size(), static_cast<std::size_t>(setting.mean * 10));
    const auto exact = stats::fps_moments(schedule.intervals_s);
    EXPECT_NEAR(mean_of(exact, rules.mean), setting.mean, 1e-9);
    EXPECT_NEAR(exact.sd, setting.sd, 1e-9);
    const auto whole = stats::fps_moments(seconds(schedule.intervals_ns));
    EXPECT_NEAR(mean_of(whole, rules.mean), setting.mean, 1e-6);
    EXPECT_NEAR(whole.sd, setting.sd, 1e-6);
    const double longest = *std::max_element(schedule.intervals_s.begin(), schedule.intervals_s.end());
    EXPECT_LE(longest, 0.250 + 1e-12);
  }
}

TEST_P(PilotSchedules, AreThereForShortTrialsToo) {
  for (const double duration : {1.0, 2.0, 5.0}) {
    for (auto setting : pilot_settings()) {
      setting.duration_s = duration;
      SCOPED_TRACE(study::setting_name(setting) + " over " + std::to_string(duration));
      const auto schedule = study::compile_schedule(setting, rules_with(GetParam()), 7);
      const auto whole = stats::fps_moments(seconds(schedule.intervals_ns));
      EXPECT_NEAR(mean_of(whole, GetParam()), setting.mean, 1e-6 * setting.mean);
      EXPECT_NEAR(whole.sd, setting.sd, 1e-6 * std::max(1.0, setting.sd));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothMeans, PilotSchedules, testing::Values(FpsMean::Harmonic, FpsMean::Arithmetic),
                         [](const auto& mean) {
                           return mean.param == FpsMean::Harmonic ? "Harmonic" : "Arithmetic";
                         });

std::string error_of(const FpsSetting& setting, const PacingRules& rules) {
  try {
    study::compile_schedule(setting, rules, 1);
  } catch (const base::Error& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(Schedule, NoSolutionNamesTheSettingAndWhy) {
  // Ten frames of exponentially distributed rates above 4 frames/s cannot have a mean as low as 20 with an SD
  // of 15.
  EXPECT_THAT(error_of({20, 15, 0.5}, rules_with(FpsMean::Arithmetic)),
              testing::AllOf(testing::HasSubstr("setting (20, 15) over 0.5 s"),
                             testing::HasSubstr("at least 20.6"), testing::HasSubstr("lower fps_min")));
  PacingRules capped;
  capped.fps_max = 60;
  EXPECT_THAT(error_of({50, 20, 10}, capped), testing::AllOf(testing::HasSubstr("setting (50, 20)"),
                                                             testing::HasSubstr("the sd is at most")));
  EXPECT_THAT(error_of({3, 0, 10}, {}), testing::HasSubstr("setting (3, 0)"));
  EXPECT_THAT(error_of({3, 1, 10}, {}), testing::HasSubstr("setting (3, 1)"));
  EXPECT_THAT(error_of({10, 5, 0.1}, {}), testing::HasSubstr("one frame has no standard deviation"));
}

TEST(Schedule, KeepsTheUpperCutAndTheLongestInterval) {
  for (const auto mean : {FpsMean::Harmonic, FpsMean::Arithmetic}) {
    PacingRules rules = rules_with(mean);
    rules.fps_max = 90;
    rules.max_interval_ms = 100;
    for (const FpsSetting& setting : {FpsSetting{50, 15, 10}, {30, 10, 10}, {80, 5, 10}, {89, 0.5, 10}}) {
      SCOPED_TRACE(study::setting_name(setting));
      const auto schedule = study::compile_schedule(setting, rules, 3);
      const auto moments = stats::fps_moments(schedule.intervals_s);
      EXPECT_NEAR(mean_of(moments, mean), setting.mean, 1e-9 * setting.mean);
      EXPECT_NEAR(moments.sd, setting.sd, 1e-9 * setting.sd);
      const auto [shortest, longest] =
          std::minmax_element(schedule.intervals_s.begin(), schedule.intervals_s.end());
      EXPECT_GE(*shortest, 1.0 / 90 - 1e-12);
      EXPECT_LE(*longest, 0.1 + 1e-12);
    }
  }
}

TEST(Schedule, NoSpreadIsConstant) {
  const auto schedule = study::compile_schedule({30, 0, 10}, {}, 5);
  EXPECT_EQ(schedule.intervals_ns, std::vector<std::int64_t>(300, 33333333));
}

TEST(Schedule, ManyFramesOfAHighRateStillHoldTheirMoments) {
  const FpsSetting setting{240, 3, 60};
  const auto schedule = study::compile_schedule(setting, {}, 5);
  const auto whole = stats::fps_moments(seconds(schedule.intervals_ns));
  EXPECT_NEAR(whole.mean, 240, 240e-6);
  EXPECT_NEAR(whole.sd, 3, 3e-6);
}

TEST(FrameOrder, FollowsTheSeed) {
  const FpsSetting setting{30, 10, 10};
  for (const auto order : {study::FrameOrder::White, study::FrameOrder::Ar1}) {
    PacingRules rules;
    rules.order = order;
    rules.ar1 = 0.5;
    const auto one = study::compile_schedule(setting, rules, 1).intervals_ns;
    EXPECT_EQ(one, study::compile_schedule(setting, rules, 1).intervals_ns);
    EXPECT_NE(one, study::compile_schedule(setting, rules, 2).intervals_ns);
  }
}

// exact_rates() keeps the rates that it found. Problems that differ in one number must not share them.
TEST(ExactRates, OfProblemsThatDifferInOneNumberAreTheirOwn) {
  std::vector<PacingRules> rules(4);
  rules[1].mean = FpsMean::Arithmetic;
  rules[2].fps_min = 15;
  rules[3].fps_max = 60;
  const std::vector<FpsSetting> settings{{30, 5, 10}, {30, 5, 5}, {30, 6, 10}, {30.04, 5, 10}};
  std::vector<std::vector<double>> found;
  for (const int round : {0, 1}) {
    std::size_t at = 0;
    for (const PacingRules& rule : rules) {
      for (const FpsSetting& setting : settings) {
        const auto rates = study::exact_rates(setting, rule);
        ASSERT_EQ(rates.size(), static_cast<std::size_t>(study::frame_count(setting)));
        EXPECT_NEAR(study::mean_rate(rates, rule.mean), setting.mean, 1e-6);
        EXPECT_GE(rates.front(), rule.fps_min);
        EXPECT_LE(rates.back(), rule.fps_max.value_or(INFINITY));
        if (round == 0) {
          for (const auto& other : found) EXPECT_NE(rates, other);
          found.push_back(rates);
        }
        EXPECT_EQ(rates, found.at(at++));
      }
    }
  }
}

TEST(FrameOrder, Ar1ReachesTheWishedCorrelation) {
  for (const double wished : {-0.9, -0.4, 0.0, 0.3, 0.8}) {
    PacingRules rules;
    rules.order = study::FrameOrder::Ar1;
    rules.ar1 = wished;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const auto rates = rates_of(study::compile_schedule({30, 10, 10}, rules, seed));
      EXPECT_NEAR(study::lag1(rates), wished, 0.01) << wished << ' ' << seed;
    }
  }
}

TEST(FrameOrder, TraceGivesItsRanks) {
  PacingRules rules;
  rules.order = study::FrameOrder::Trace;
  rules.trace_rates = {30, 10, 50, 20, 40};
  const auto rates = study::ordered({1, 2, 3, 4, 5}, rules, 1);
  EXPECT_EQ(rates, (std::vector<double>{3, 1, 5, 2, 4}));
  // For ten frames the trace of five repeats: the same frames of both halves have rates above the median,
  // except the first, whose rate is the trace's median.
  const auto longer = study::ordered({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, rules, 1);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ((longer[i] > 5.5), (longer[i + 5] > 5.5) || i == 0);
}

TEST(FrameOrder, LagOneOfKnownLists) {
  EXPECT_EQ(study::lag1(std::vector<double>{1, 1, 1}), 0);
  EXPECT_EQ(study::lag1(std::vector<double>{2}), 0);
  EXPECT_DOUBLE_EQ(study::lag1(std::vector<double>{1, -1, 1, -1}), -0.75);
}

TEST(TruncatedNormal, TendsToItsLimits) {
  // Arguments: cut, width, n. Returns the distances from `cut` of n quantiles of a standard normal
  // distribution between cut and cut + width.
  // Hardly truncated (cut = -12): a normal distribution around -cut. Its quartiles lie 0.674489750196
  // standard deviations from the mean.
  const auto bell = study::truncated_normal_strata(-12, INFINITY, 2);
  EXPECT_NEAR(bell[0], 12 - 0.6744897501960817, 1e-12);
  EXPECT_NEAR(bell[1], 12 + 0.6744897501960817, 1e-12);
  // Truncated at the mean: the median of a half-normal.
  EXPECT_NEAR(study::truncated_normal_strata(0, INFINITY, 1)[0], 0.6744897501960817, 1e-14);
  // Far out in the tail: an exponential distribution with the rate `cut`.
  const auto tail = study::truncated_normal_strata(1e6, INFINITY, 2);
  EXPECT_NEAR(tail[0] * 1e6, -std::log(0.75), 1e-11);
  EXPECT_NEAR(tail[1] * 1e6, -std::log(0.25), 1e-11);
  // In a narrow window around the mean: a uniform distribution.
  const auto flat = study::truncated_normal_strata(-5e-4, 1e-3, 4);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(flat[i] / 1e-3, (static_cast<double>(i) + 0.5) / 4, 1e-7);
  // Mirrored windows give mirrored values.
  const auto left = study::truncated_normal_strata(-5, 3, 7);
  const auto right = study::truncated_normal_strata(2, 3, 7);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(left[i], 3 - right[6 - i], 1e-13);
}

TEST(FindRoot, FindsItAndRefusesWhatHasNone) {
  EXPECT_NEAR(stats::find_root([](double x) { return std::cos(x) - x; }, 0, 1), 0.7390851332151607, 1e-15);
  EXPECT_THROW(stats::find_root([](double x) { return x * x + 1; }, -1, 1), std::invalid_argument);
}

}  // namespace
