#include "libstudy/design/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "libstudy/design/orders.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using study::Plan;
using study::PlannedTrial;
using study::Protocol;

Protocol shipped(const std::string& name) {
  return study::read_protocol(base::resource("protocols/" + name + ".toml"));
}

const study::StimulusSpec& stimulus_of(const Protocol& protocol, int cell) {
  return protocol.design.cells.at(static_cast<std::size_t>(cell)).stimulus;
}

study::BlockKind kind_of(const Protocol& protocol, int block) {
  return protocol.blocks.at(static_cast<std::size_t>(block)).kind;
}

/// The trials of the design alone.
std::vector<PlannedTrial> design_trials(const Protocol& protocol, const Plan& plan) {
  std::vector<PlannedTrial> out;
  for (const auto& trial : plan.trials) {
    if (kind_of(protocol, trial.block) == study::BlockKind::Stimulus) out.push_back(trial);
  }
  return out;
}

std::vector<int> order_of(const Plan& plan) {
  std::vector<int> order;
  for (const auto& trial : plan.trials) order.push_back(trial.first);
  return order;
}

/// chi-square of counts against their mean, in standard deviations from `freedom` degrees.
double chi_square_z(const std::vector<int>& counts, double freedom, double scale = 1) {
  const double expected = std::accumulate(counts.begin(), counts.end(), 0.0) / double(counts.size());
  double chi2 = 0;
  for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
  return (scale * chi2 - freedom) / std::sqrt(2 * freedom);
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

// Must show 5 of the plans: 200 people, each setting at each place and after each other.
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
  // Sums of permutation matrices: (n - 1) / n of the statistic has (n - 1)^2 degrees of freedom.
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

/// "scene n_*, scene n_*" as a participant meets them.
std::string sequence_of(const Protocol& protocol, const Plan& plan) {
  std::string out;
  int last = -1;
  for (const auto& trial : design_trials(protocol, plan)) {
    if (trial.group == last) continue;
    last = trial.group;
    const auto& what = stimulus_of(protocol, trial.first);
    out += what.scene + " " + what.n_star + ", ";
  }
  return out;
}

TEST(Task1Plan, EachRoundDealsEverySequenceOnce) {
  const auto protocol = shipped("task1");
  EXPECT_EQ(study::sequence_count(protocol), 12);
  EXPECT_EQ(study::slot_count(protocol), 12);
  std::set<std::string> sequences;
  for (int slot = 0; slot < 12; ++slot)
    sequences.insert(sequence_of(protocol, study::make_plan(protocol, "P", 1, slot)));
  EXPECT_EQ(sequences.size(), 12u);
}

TEST(Task1Plan, ShowsTwoScenesOneAtEachNStarAndAllMethodsInEach) {
  const auto protocol = shipped("task1");
  for (int slot = 0; slot < 24; ++slot) {
    const auto plan = study::make_plan(protocol, "P" + std::to_string(slot), 1, slot % 12);
    ASSERT_EQ(plan.trials.size(), 10u);
    std::set<std::string> scenes, sizes, all;
    std::map<int, std::set<std::string>> methods, scene_of_group;
    for (const auto& trial : plan.trials) {
      const auto& what = stimulus_of(protocol, trial.first);
      scenes.insert(what.scene);
      sizes.insert(what.n_star);
      methods[trial.group].insert(what.method);
      scene_of_group[trial.group].insert(what.scene + what.n_star);
      EXPECT_EQ(trial.group, trial.position / 5);
    }
    EXPECT_EQ(scenes.size(), 2u);
    EXPECT_EQ(sizes.size(), 2u);
    for (int group = 0; group < 2; ++group) {
      EXPECT_EQ(methods[group].size(), 5u);
      EXPECT_EQ(scene_of_group[group].size(), 1u);
    }
  }
}

TEST(Task1Plan, PaperRandomDrawsScenesAndNStarFreely) {
  auto protocol = shipped("task1");
  protocol.design.assignment = study::Assignment::PaperRandom;
  EXPECT_EQ(study::slot_count(protocol), 1);
  std::map<std::string, int> count;
  for (int person = 0; person < 480; ++person)
    ++count[sequence_of(protocol, study::make_plan(protocol, "P" + std::to_string(person), 1, 0))];
  // Six orders of two scenes, each with either n_*: never one scene twice, but the same n_* twice at times.
  ASSERT_EQ(count.size(), 24u);
  std::vector<int> counts;
  for (const auto& [sequence, times] : count) {
    counts.push_back(times);
    std::istringstream words(sequence);
    std::string first, n_first, second;
    words >> first >> n_first >> second;
    EXPECT_NE(first, second);
  }
  EXPECT_LT(std::abs(chi_square_z(counts, 23)), 4);
}

TEST(Task1Plan, WilliamsRowsAreBalancedWithinEachSequence) {
  auto protocol = shipped("task1");
  protocol.design.order = study::TrialOrder::Williams;
  ASSERT_EQ(study::slot_count(protocol), 12 * 10);
  std::map<std::tuple<std::string, int, std::string, std::string>, int> successors;
  for (int slot = 0; slot < study::slot_count(protocol); ++slot) {
    const auto plan = study::make_plan(protocol, "P", 1, slot);
    const auto sequence = sequence_of(protocol, plan);
    for (std::size_t i = 1; i < plan.trials.size(); ++i) {
      if (plan.trials[i].group != plan.trials[i - 1].group) continue;
      ++successors[{sequence, plan.trials[i].group, stimulus_of(protocol, plan.trials[i - 1].first).method,
                    stimulus_of(protocol, plan.trials[i].first).method}];
    }
  }
  EXPECT_EQ(successors.size(), 12u * 2 * 20);
  for (const auto& [what, count] : successors) EXPECT_EQ(count, 2);
}

/// (scene, method, method) -> how often the first of them, by name, was shown first, and second.
using IntervalCounts = std::map<std::tuple<std::string, std::string, std::string>, std::pair<int, int>>;

void count_intervals(const Protocol& protocol, const Plan& plan, IntervalCounts& counts) {
  for (const auto& trial : design_trials(protocol, plan)) {
    const auto& first = stimulus_of(protocol, trial.first);
    const auto& second = stimulus_of(protocol, *trial.second);
    EXPECT_EQ(first.scene, second.scene);
    auto& count =
        counts[{first.scene, std::min(first.method, second.method), std::max(first.method, second.method)}];
    ++(first.method < second.method ? count.first : count.second);
  }
}

TEST(Task2Plan, ShowsEveryPairOnce) {
  const auto protocol = shipped("task2");
  for (int slot = 0; slot < study::slot_count(protocol); ++slot) {
    const auto plan = study::make_plan(protocol, "P", 1, slot);
    EXPECT_EQ(plan.trials.size(), 10u);
    IntervalCounts counts;
    count_intervals(protocol, plan, counts);
    EXPECT_EQ(counts.size(), 10u);
  }
}

TEST(Task2Plan, CouplesOfRoundsShowEachPairInBothOrders) {
  const auto protocol = shipped("task2");
  const int slots = study::slot_count(protocol);
  ASSERT_EQ(slots % 6, 0);
  std::set<std::vector<bool>> patterns;
  for (int couple = 0; couple < slots / 6; ++couple) {
    IntervalCounts counts;
    for (int slot = 6 * couple; slot < 6 * couple + 6; ++slot)
      count_intervals(protocol, study::make_plan(protocol, "P" + std::to_string(slot), 1, slot), counts);
    EXPECT_EQ(counts.size(), 30u);
    for (const auto& [what, count] : counts) EXPECT_EQ(count, (std::pair<int, int>(1, 1)));
    IntervalCounts one;
    count_intervals(protocol, study::make_plan(protocol, "P", 1, 6 * couple), one);
    std::vector<bool> pattern;
    for (const auto& [what, count] : one) pattern.push_back(count.first == 1);
    patterns.insert(pattern);
  }
  EXPECT_GT(patterns.size(), 10u);  // the couples differ
}

TEST(Task2Plan, Deals26PeopleThreeScenesNearlyEqually) {
  const auto protocol = shipped("task2");
  std::vector<int> taken;
  std::map<std::string, int> scenes;
  IntervalCounts counts;
  for (int person = 0; person < 26; ++person) {
    taken.push_back(study::next_slot(protocol, taken));
    const auto plan = study::make_plan(protocol, "P" + std::to_string(person), 1, taken.back());
    ++scenes[stimulus_of(protocol, plan.trials.at(0).first).scene];
    count_intervals(protocol, plan, counts);
  }
  std::vector<int> sizes;
  for (const auto& [scene, count] : scenes) sizes.push_back(count);
  std::sort(sizes.begin(), sizes.end());
  EXPECT_EQ(sizes, (std::vector<int>{8, 9, 9}));
  for (const auto& [what, count] : counts) EXPECT_LE(std::abs(count.first - count.second), 1);
}

TEST(Task2Plan, PaperRandomDrawsIntervalsFreely) {
  auto protocol = shipped("task2");
  protocol.design.assignment = study::Assignment::PaperRandom;
  EXPECT_EQ(study::slot_count(protocol), 1);
  int alphabetical = 0;
  for (int person = 0; person < 200; ++person) {
    IntervalCounts counts;
    count_intervals(protocol, study::make_plan(protocol, "P" + std::to_string(person), 1, 0), counts);
    for (const auto& [what, count] : counts) alphabetical += count.first;
  }
  EXPECT_NEAR(alphabetical, 1000, 5 * std::sqrt(500.0));
}

TEST(Task2Plan, RowsMeetBothIntervalOrders) {
  auto protocol = shipped("task2");
  protocol.design.order = study::TrialOrder::Latin;
  // (scene, pair at the first place) -> both orders equally often
  IntervalCounts counts;
  for (int slot = 0; slot < study::slot_count(protocol); ++slot) {
    auto plan = study::make_plan(protocol, "P", 1, slot);
    plan.trials.resize(1);
    count_intervals(protocol, plan, counts);
  }
  EXPECT_EQ(counts.size(), 30u);
  for (const auto& [what, count] : counts) {
    EXPECT_EQ(count.first, count.second);
    EXPECT_EQ(count.first + count.second, study::slot_count(protocol) / 30);
  }
}

TEST(Slots, FillGapsFirstAndStartOverWhenAllAreTaken) {
  const auto protocol = shipped("task1");
  std::vector<int> taken;
  for (int person = 0; person < 12; ++person) {
    EXPECT_EQ(study::next_slot(protocol, taken), person);
    taken.push_back(person);
  }
  EXPECT_EQ(study::next_slot(protocol, taken), 0);
  taken.push_back(0);
  taken.push_back(1);
  // Those in slots 7 and 3 drop out: their places are filled before the second round goes on.
  std::erase(taken, 7);
  std::erase(taken, 3);
  EXPECT_EQ(study::next_slot(protocol, taken), 3);
  taken.push_back(3);
  EXPECT_EQ(study::next_slot(protocol, taken), 7);
  taken.push_back(7);
  EXPECT_EQ(study::next_slot(protocol, taken), 2);
}

TEST(Slots, StayBalancedThroughManyWithdrawals) {
  const auto protocol = shipped("task1");
  const int slots = study::slot_count(protocol);
  std::vector<int> taken;
  study::RandomStream random(5);
  for (int step = 0; step < 300; ++step) {
    taken.push_back(study::next_slot(protocol, taken));
    if (step % 3 == 2) taken.erase(taken.begin() + static_cast<std::ptrdiff_t>(random.below(taken.size())));
  }
  // Newcomers without further withdrawals even out what the last ones left.
  for (int step = 0; step < slots; ++step) taken.push_back(study::next_slot(protocol, taken));
  std::vector<int> count(static_cast<std::size_t>(slots));
  for (const int slot : taken) ++count[static_cast<std::size_t>(slot)];
  EXPECT_LE(*std::max_element(count.begin(), count.end()) - *std::min_element(count.begin(), count.end()), 1);
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
  cells.erase(cells.begin());  // the first group has four methods now
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
      if (planned.count == 0) continue;
      EXPECT_EQ(count[static_cast<int>(block)], planned.count) << planned.id;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Protocols, LabPlan,
                         testing::Values("ptpe_pilot_lab", "task1_lab", "task2_lab", "demo"));

TEST(Task1Plan, HasABreakBetweenTheScenes) {
  const auto protocol = shipped("task1");
  const auto plan = study::make_plan(protocol, "P01", 1, 0);
  std::vector<int> breaks;
  for (const auto& unit : plan.units) {
    if (!unit.trial && kind_of(protocol, unit.block) == study::BlockKind::Stimulus)
      breaks.push_back(unit.position);
  }
  EXPECT_EQ(breaks, std::vector<int>{2 + 5});  // two pages and five trials come before it
}

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
  const char* sha256;  // its first 16 digits
};

class GoldenPlan : public testing::TestWithParam<Golden> {};

// Equal numbers on every machine and in every build, with CUDA or without. The protocols' own hashes are left
// out, so that a word changed in one of them changes none of these.
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
                                         Golden{"task1_lab", "", 9223372036854775807u, 3, "8220fcabe94b8412"},
                                         Golden{"task2", "", 7, 0, "9e41aa98dd4e585c"},
                                         Golden{"task2", "", 7, 95, "506671e72e501542"},
                                         Golden{"task2", "paper_random", 7, 0, "70e08048172d7673"},
                                         Golden{"task2_lab", "", 7, 4, "bb3f740fda5ed94a"},
                                         Golden{"demo", "", 7, 0, "1db73a21b4545640"}));

// Worked out by an independent implementation of Philox and Durstenfeld's shuffle.
TEST(Plan, ShufflesAsAnIndependentImplementationDoes) {
  auto protocol = shipped("ptpe_pilot");
  protocol.sha256 = std::string(64, '0');
  protocol.design.cells.resize(8);
  EXPECT_EQ(order_of(study::make_plan(protocol, "P01", 7, 0)), (std::vector<int>{7, 0, 5, 1, 3, 6, 2, 4}));
}

}  // namespace
