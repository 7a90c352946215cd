#include "libstudy/design/plan.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "libstudy/design/orders.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/plan_fixture.hpp"

namespace {

using namespace study::test;
using study::Plan;
using study::PlannedTrial;
using study::Protocol;

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
  // A bound of 3/4 of the range: reduction modulo the bound would draw the lower third twice as often as each
  // other third.
  const std::uint64_t bound = 3ull << 62;
  study::RandomStream random(1);
  int lower = 0;
  constexpr int draws = 30000;
  for (int i = 0; i < draws; ++i) lower += random.below(bound) < bound / 3;
  EXPECT_NEAR(lower, draws / 3.0, 5 * std::sqrt(draws * 2.0 / 9));
}

TEST(Plan, IsAPureFunctionOfItsInputs) {
  const auto protocol = shipped("ptpe_pilot");
  const auto order = order_of(study::make_plan(protocol, "P01", 7, 0));
  EXPECT_EQ(order, order_of(study::make_plan(protocol, "P01", 7, 0)));
  EXPECT_NE(order, order_of(study::make_plan(protocol, "P02", 7, 0)));
  EXPECT_NE(order, order_of(study::make_plan(protocol, "P01", 8, 0)));
  auto other = protocol;
  study::override_trial_seconds(other, 2);
  EXPECT_NE(order, order_of(study::make_plan(other, "P01", 7, 0)));
}

TEST(Plan, HoldsEverySettingOnceWithItsOwnSeed) {
  const auto protocol = shipped("ptpe_pilot");
  const auto plan = study::make_plan(protocol, "P01", 7, 0);
  ASSERT_EQ(plan.trials.size(), 21u);
  std::set<int> cells;
  std::set<std::uint64_t> seeds;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    EXPECT_EQ(plan.trials[i].position, static_cast<int>(i));
    EXPECT_FALSE(plan.trials[i].second);
    cells.insert(plan.trials[i].first);
    seeds.insert(plan.trials[i].schedule_seed);
  }
  EXPECT_EQ(cells.size(), 21u);
  EXPECT_EQ(*cells.begin(), 0);
  EXPECT_EQ(*cells.rbegin(), 20);
  EXPECT_EQ(seeds.size(), 21u);
}

// Over 200 people, counts how often each setting is at each place, and how often each setting follows each
// other one.
TEST(Plan, PermutesThePilotEvenlyOver200People) {
  const auto protocol = shipped("ptpe_pilot");
  constexpr std::size_t n = 21;
  std::vector<int> places(n * n), successors(n * (n - 1));
  for (int person = 0; person < 200; ++person) {
    const auto order = order_of(study::make_plan(protocol, "P" + std::to_string(person), 1, 0));
    for (std::size_t i = 0; i < n; ++i) {
      const auto now = static_cast<std::size_t>(order[i]);
      ++places[i * n + now];
      if (i + 1 == n) continue;
      const auto next = static_cast<std::size_t>(order[i + 1]);
      ++successors[now * (n - 1) + next - (next > now)];
    }
  }
  // The counts of places are sums of permutation matrices of size n: (n - 1) / n of their chi-square has (n -
  // 1)^2 degrees of freedom.
  EXPECT_LT(std::abs(chi_square_z(places, 400, 20.0 / 21)), 4);
  EXPECT_LT(std::abs(chi_square_z(successors, 419)), 4);
}

TEST(Orders, LatinRowsHaveEachThingOnceAtEachPlace) {
  for (int k = 2; k <= 9; ++k) {
    std::set<std::pair<int, int>> seen;
    for (int row = 0; row < k; ++row) {
      const auto order = study::latin_row(k, row);
      ASSERT_EQ(order.size(), static_cast<std::size_t>(k));
      for (int place = 0; place < k; ++place) {
        ASSERT_GE(order[static_cast<std::size_t>(place)], 0);
        ASSERT_LT(order[static_cast<std::size_t>(place)], k);
        EXPECT_TRUE(seen.emplace(place, order[static_cast<std::size_t>(place)]).second) << k;
      }
    }
  }
}

TEST(Orders, WilliamsRowsBalancePlacesAndCarryOver) {
  for (int k = 2; k <= 9; ++k) {
    const int rows = study::williams_rows(k);
    EXPECT_EQ(rows, k % 2 ? 2 * k : k);
    std::map<std::pair<int, int>, int> places, successors;
    for (int row = 0; row < rows; ++row) {
      const auto order = study::williams_row(k, row);
      EXPECT_EQ(std::set<int>(order.begin(), order.end()).size(), static_cast<std::size_t>(k));
      for (std::size_t i = 0; i < order.size(); ++i) {
        ++places[{static_cast<int>(i), order[i]}];
        if (i) ++successors[{order[i - 1], order[i]}];
      }
    }
    EXPECT_EQ(places.size(), static_cast<std::size_t>(k * k));
    for (const auto& [what, count] : places) EXPECT_EQ(count, rows / k) << k;
    EXPECT_EQ(successors.size(), static_cast<std::size_t>(k * (k - 1)));
    for (const auto& [what, count] : successors) EXPECT_EQ(count, rows / k) << k;
  }
}

TEST(Plan, ConstrainedOrdersKeepTheirRule) {
  auto protocol = shipped("ptpe_pilot");
  protocol.design.order = study::TrialOrder::Constrained;
  protocol.design.never_adjacent = {"mean_fps", "sd_fps"};
  std::set<std::vector<int>> orders;
  for (int person = 0; person < 50; ++person) {
    const auto order = order_of(study::make_plan(protocol, "P" + std::to_string(person), 1, 0));
    EXPECT_EQ(std::set<int>(order.begin(), order.end()).size(), 21u);
    for (std::size_t i = 1; i < order.size(); ++i) {
      const auto& before = protocol.design.cells[static_cast<std::size_t>(order[i - 1])].setting;
      const auto& after = protocol.design.cells[static_cast<std::size_t>(order[i])].setting;
      EXPECT_NE(before.mean, after.mean);
      EXPECT_NE(before.sd, after.sd);
    }
    orders.insert(order);
  }
  EXPECT_EQ(orders.size(), 50u);
}

TEST(Plan, ARuleThatNoOrderKeepsIsAnError) {
  auto protocol = shipped("ptpe_pilot");
  protocol.design.order = study::TrialOrder::Constrained;
  protocol.design.never_adjacent = {"method"};
  EXPECT_THROW(study::make_plan(protocol, "P01", 1, 0), base::Error);
}

TEST(Plan, GroupsMayHaveUnequalNumbersOfCells) {
  auto protocol = shipped("task1");
  auto& cells = protocol.design.cells;
  cells.erase(cells.begin());  // the first group now has four methods
  protocol.design.order = study::TrialOrder::Williams;
  EXPECT_EQ(study::slot_count(protocol), 12 * std::lcm(4, 10));
  for (int slot = 0; slot < study::slot_count(protocol); slot += 7) {
    const auto plan = study::make_plan(protocol, "P", 1, slot);
    std::set<int> shown;
    for (const auto& trial : plan.trials) shown.insert(trial.first);
    EXPECT_EQ(shown.size(), plan.trials.size());
    EXPECT_TRUE(plan.trials.size() == 9 || plan.trials.size() == 10);
  }
}

void expect_units_in_order(const Protocol& protocol, const Plan& plan) {
  int trial = 0;
  for (std::size_t i = 0; i < plan.units.size(); ++i) {
    const auto& unit = plan.units[i];
    EXPECT_EQ(unit.position, static_cast<int>(i));
    if (!unit.trial) continue;
    EXPECT_EQ(*unit.trial, trial);
    EXPECT_EQ(plan.trials.at(static_cast<std::size_t>(trial)).block, unit.block);
    EXPECT_TRUE(study::has_trials(kind_of(protocol, unit.block)));
    ++trial;
  }
  EXPECT_EQ(static_cast<std::size_t>(trial), plan.trials.size());
}

class LabPlan : public testing::TestWithParam<const char*> {};

TEST_P(LabPlan, PutsPracticeRepeatsAndCatchesInTheirPlaces) {
  const auto protocol = shipped(GetParam());
  for (int slot = 0; slot < std::min(study::slot_count(protocol), 12); ++slot) {
    const auto plan = study::make_plan(protocol, "P" + std::to_string(slot), 3, slot);
    expect_units_in_order(protocol, plan);
    const auto shown = design_trials(protocol, plan);
    std::set<std::pair<int, int>> repeated;
    std::map<int, int> count;  // trials by block
    for (const auto& trial : plan.trials) {
      ++count[trial.block];
      const auto kind = kind_of(protocol, trial.block);
      if (kind == study::BlockKind::Practice) {
        EXPECT_LT(trial.position, shown.front().position);
        EXPECT_EQ(stimulus_of(protocol, trial.first).scene, stimulus_of(protocol, shown.front().first).scene);
      }
      if (kind != study::BlockKind::Repeat) continue;
      EXPECT_GT(trial.position, shown.back().position);
      EXPECT_TRUE(repeated.emplace(trial.first, trial.second.value_or(-1)).second);
      EXPECT_TRUE(std::any_of(shown.begin(), shown.end(), [&](const PlannedTrial& one) {
        return one.first == trial.first && one.second == trial.second &&
               one.schedule_seed == trial.schedule_seed;
      })) << "a repeat shows what was shown";
    }
    for (std::size_t i = 1; i < plan.units.size(); ++i) {
      const auto& unit = plan.units[i];
      if (kind_of(protocol, unit.block) != study::BlockKind::Catch) continue;
      ++count[unit.block];
      EXPECT_TRUE(plan.units[i - 1].trial);
      EXPECT_EQ(kind_of(protocol, plan.units[i - 1].block), study::BlockKind::Stimulus);
    }
    for (std::size_t block = 0; block < protocol.blocks.size(); ++block) {
      const auto& planned = protocol.blocks[block];
      const bool tries = planned.kind == study::BlockKind::GazeValidation;
      if (planned.count == 0 || tries) continue;
      EXPECT_EQ(count[static_cast<int>(block)], planned.count) << planned.id;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Protocols, LabPlan,
                         testing::Values("ptpe_pilot_lab", "task1_lab", "task2_lab", "demo"));

/// Everything of a plan as text.
std::string text_of(const Plan& plan) {
  std::ostringstream out;
  for (const auto& unit : plan.units) out << unit.block << ' ' << unit.trial.value_or(-1) << '\n';
  for (const auto& trial : plan.trials) {
    out << trial.block << ' ' << trial.group << ' ' << trial.first << ' ' << trial.second.value_or(-1) << ' '
        << trial.schedule_seed << '\n';
  }
  return out.str();
}

struct Golden {
  const char* protocol;
  const char* order;
  std::uint64_t seed;
  int slot;
  const char* sha256;  // of text_of(plan), the first 16 digits
};

class GoldenPlan : public testing::TestWithParam<Golden> {};

// The plans must be equal on every machine and in every build, with CUDA or without. The protocols' hashes,
// which seed the plans, are set to zero, so that a changed word in a protocol changes no plan.
TEST_P(GoldenPlan, StaysTheSame) {
  const auto& golden = GetParam();
  auto protocol = shipped(golden.protocol);
  protocol.sha256 = std::string(64, '0');
  const std::string order = golden.order;
  if (order == "latin") protocol.design.order = study::TrialOrder::Latin;
  if (order == "williams") protocol.design.order = study::TrialOrder::Williams;
  if (order == "paper_random") protocol.design.assignment = study::Assignment::PaperRandom;
  const auto plan = study::make_plan(protocol, "P01", golden.seed, golden.slot);
  EXPECT_EQ(base::sha256_hex(text_of(plan)).substr(0, 16), golden.sha256) << text_of(plan);
}

INSTANTIATE_TEST_SUITE_P(Plans, GoldenPlan,
                         testing::Values(Golden{"ptpe_pilot", "", 7, 0, "ec6b0b3ffa75b80f"},
                                         Golden{"ptpe_pilot", "", 8, 0, "3957edd92d34b63f"},
                                         Golden{"ptpe_pilot_lab", "", 7, 0, "1b6ef119961f9c77"},
                                         Golden{"task1", "", 7, 0, "7d8d70639f1ac6d8"},
                                         Golden{"task1", "", 7, 11, "11b812d3a167fe09"},
                                         Golden{"task1", "latin", 7, 30, "35dc3fb51c10179f"},
                                         Golden{"task1", "williams", 7, 100, "80f6e1289ae71149"},
                                         Golden{"task1", "paper_random", 7, 0, "0ddd76f466356acb"},
                                         Golden{"task1_lab", "", 9223372036854775807u, 3, "431222734aed0f12"},
                                         Golden{"task2", "", 7, 0, "9e41aa98dd4e585c"},
                                         Golden{"task2", "", 7, 95, "506671e72e501542"},
                                         Golden{"task2", "paper_random", 7, 0, "70e08048172d7673"},
                                         Golden{"task2_lab", "", 7, 4, "cc5c8d03bd3ee2d6"},
                                         Golden{"demo", "", 7, 0, "1db73a21b4545640"}));

// An independent implementation of Philox and Durstenfeld's shuffle computed the expected order.
TEST(Plan, ShufflesAsAnIndependentImplementationDoes) {
  auto protocol = shipped("ptpe_pilot");
  protocol.sha256 = std::string(64, '0');
  protocol.design.cells.resize(8);
  EXPECT_EQ(order_of(study::make_plan(protocol, "P01", 7, 0)), (std::vector<int>{7, 0, 5, 1, 3, 6, 2, 4}));
}

}  // namespace
