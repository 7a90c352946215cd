#include "libstudy/design/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "stats/base/file.hpp"

namespace {

study::Protocol pilot() { return study::read_protocol(base::resource("protocols/ptpe_pilot.toml")); }

std::vector<int> order_of(const std::vector<study::PlannedTrial>& plan) {
  std::vector<int> order;
  for (const auto& trial : plan) order.push_back(trial.setting);
  return order;
}

// Known answers published with Random123 (kat_vectors, philox4x32 10).
TEST(Random, PhiloxGivesThePublishedAnswers) {
  using Four = std::array<std::uint32_t, 4>;
  EXPECT_EQ(study::philox4x32({0, 0, 0, 0}, {0, 0}), (Four{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(study::philox4x32({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
            (Four{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(study::philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Four{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, BelowRejectsInsteadOfFolding) {
  // A bound of 3/4 of the range: folding would draw the lower third twice as often as the rest.
  const std::uint64_t bound = 3ull << 62;
  study::RandomStream random(1);
  int lower = 0;
  constexpr int draws = 30000;
  for (int i = 0; i < draws; ++i) lower += random.below(bound) < bound / 3;
  EXPECT_NEAR(lower, draws / 3.0, 5 * std::sqrt(draws * 2.0 / 9));
}

TEST(Plan, IsAPureFunctionOfItsInputs) {
  const auto protocol = pilot();
  const auto order = order_of(study::make_plan(protocol, "P01", 7));
  EXPECT_EQ(order, order_of(study::make_plan(protocol, "P01", 7)));
  EXPECT_NE(order, order_of(study::make_plan(protocol, "P02", 7)));
  EXPECT_NE(order, order_of(study::make_plan(protocol, "P01", 8)));
  auto other = protocol;
  study::override_trial_seconds(other, 2);
  EXPECT_NE(order, order_of(study::make_plan(other, "P01", 7)));
}

TEST(Plan, HoldsEverySettingOnceWithItsOwnSeed) {
  const auto protocol = pilot();
  const auto plan = study::make_plan(protocol, "P01", 7);
  ASSERT_EQ(plan.size(), protocol.settings.size());
  std::map<int, std::uint64_t> seeds;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(plan[i].position, static_cast<int>(i));
    seeds[plan[i].setting] = plan[i].schedule_seed;
  }
  EXPECT_EQ(seeds.size(), plan.size());
  EXPECT_EQ(seeds.begin()->first, 0);
  std::vector<std::uint64_t> values;
  for (const auto& [setting, seed] : seeds) values.push_back(seed);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(std::adjacent_find(values.begin(), values.end()), values.end());
}

// Worked out by an independent implementation, so that every machine and version makes this plan.
TEST(Plan, StaysTheSameForAPinnedHash) {
  study::Protocol protocol;
  protocol.sha256 = std::string(64, '0');
  protocol.settings.resize(8);
  const auto order = order_of(study::make_plan(protocol, "P01", 7));
  EXPECT_EQ(order, (std::vector<int>{7, 0, 5, 1, 3, 6, 2, 4}));
}

TEST(Plan, PlacesEverySettingAtEveryPositionEquallyOften) {
  const auto protocol = pilot();
  const std::size_t n = protocol.settings.size();
  std::vector<int> counts(n * n);
  constexpr int plans = 4200;
  for (int seed = 0; seed < plans; ++seed) {
    for (const auto& trial : study::make_plan(protocol, "P01", static_cast<std::uint64_t>(seed)))
      ++counts[static_cast<std::size_t>(trial.position) * n + static_cast<std::size_t>(trial.setting)];
  }
  const double expected = static_cast<double>(plans) / static_cast<double>(n);
  double chi2 = 0;
  for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
  // (n - 1)^2 degrees of freedom; five standard deviations either way.
  const double freedom = static_cast<double>((n - 1) * (n - 1));
  EXPECT_NEAR(chi2, freedom, 5 * std::sqrt(2 * freedom));
}

}  // namespace
