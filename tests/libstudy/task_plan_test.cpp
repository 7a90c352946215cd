/// The plans of Tasks 1 and 2: sequences, orders and slots.

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "tests/libstudy/plan_fixture.hpp"

namespace {

using namespace study::test;
using study::Plan;
using study::PlannedTrial;
using study::Protocol;

/// "scene number_of_particles, ..." in the order of a participant's trials.
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
  // Six orders of two different scenes, each with one of two numbers of particles: 24 sequences.
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

/// Key: scene and two methods in the order of their names. Value: the number of trials that show the first
/// method first, and the number that show it second.
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
  EXPECT_GT(patterns.size(), 10u);  // groups of six slots have different patterns
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
  // Each scene and pair in the first trial must occur in both orders equally often.
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
  // The people in slots 7 and 3 drop out: new people fill these slots before the second round continues.
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
  // After the withdrawals, new people restore the balance.
  for (int step = 0; step < slots; ++step) taken.push_back(study::next_slot(protocol, taken));
  std::vector<int> count(static_cast<std::size_t>(slots));
  for (const int slot : taken) ++count[static_cast<std::size_t>(slot)];
  EXPECT_LE(*std::max_element(count.begin(), count.end()) - *std::min_element(count.begin(), count.end()), 1);
}

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

}  // namespace
