#include "stats/preference/circular_triads.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/stats/uniformity.hpp"

namespace {

using stats::circular_triads;
using Values = std::vector<double>;

Values tournament(int items, uniformity::Draws& draws, double first_wins = 0.5) {
  const auto n = static_cast<std::size_t>(items);
  Values wins(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) wins[draws.coin(first_wins) ? i * n + j : j * n + i] = 1;
  return wins;
}

int counted(const Values& wins, std::size_t n) {
  int out = 0;
  const auto beats = [&](std::size_t i, std::size_t j) { return wins[i * n + j] == 1; };
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t c = 0; c < n; ++c)
        if (a < b && a < c && b != c) out += beats(a, b) && beats(b, c) && beats(c, a);
  return out;
}

TEST(CircularTriads, AreThoseThatGoRound) {
  uniformity::Draws draws(1);
  for (int round = 0; round < 300; ++round) {
    const int items = 3 + round % 8;
    const Values wins = tournament(items, draws);
    const auto got = circular_triads(wins, items);
    ASSERT_TRUE(got) << got.reason();
    EXPECT_EQ(got->triads, counted(wins, static_cast<std::size_t>(items)));
    EXPECT_GE(got->zeta, 0);
    EXPECT_LE(got->zeta, 1);
  }
}

TEST(CircularTriads, AnOrderHasNoneAndACircleTheMost) {
  const Values order{0, 1, 1, 1, 1, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
  const auto none = circular_triads(order, 5);
  EXPECT_EQ(none->triads, 0);
  EXPECT_EQ(none->zeta, 1);
  EXPECT_NEAR(none->p, 120.0 / 1024, 1e-15) << "5! orders among 2^10 sets of answers";
  Values circle(25, 0.0);
  for (std::size_t i = 0; i < 5; ++i) circle[i * 5 + (i + 1) % 5] = circle[i * 5 + (i + 2) % 5] = 1;
  const auto most = circular_triads(circle, 5);
  EXPECT_EQ(most->triads, 5);
  EXPECT_EQ(most->most, 5);
  EXPECT_EQ(most->zeta, 0);
  EXPECT_EQ(most->p, 1);
}

TEST(CircularTriads, KendallsTableOfSixItems) {
  // Kendall 1962, appendix table 9: how many of the 2^15 sets of answers to all pairs of six items have d =
  // 0, 1, ... circular triads.
  const std::vector<double> table{720, 960, 2240, 2880, 6240, 3648, 8640, 4800, 2640};
  ASSERT_EQ(std::accumulate(table.begin(), table.end(), 0.0), 32768);
  uniformity::Draws draws(2);
  std::map<int, double> seen;
  for (int round = 0; round < 2000; ++round) {
    const auto got = circular_triads(tournament(6, draws), 6);
    seen[got->triads] = got->p;
  }
  double cumulated = 0;
  for (int d = 0; d < 9; ++d) {
    cumulated += table[static_cast<std::size_t>(d)] / 32768;
    EXPECT_NEAR(seen.at(d), cumulated, 1e-12) << d;
  }
}

TEST(CircularTriads, TheApproximationKeepsItsLevelForManyItems) {
  uniformity::Draws draws(3);
  int low = 0;
  constexpr int rounds = 4000;
  for (int round = 0; round < rounds; ++round) low += circular_triads(tournament(10, draws), 10)->p <= 0.05;
  EXPECT_FALSE(circular_triads(tournament(10, draws), 10)->exact);
  EXPECT_NEAR(low / double{rounds}, 0.05, 0.015);
}

TEST(CircularTriads, NamesOfTheItemsDoNotMatter) {
  uniformity::Draws draws(4);
  const Values wins = tournament(5, draws);
  Values turned(25);
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = 0; j < 5; ++j) turned[i * 5 + j] = wins[(4 - i) * 5 + 4 - j];
  EXPECT_EQ(circular_triads(wins, 5)->triads, circular_triads(turned, 5)->triads);
}

TEST(CircularTriads, RefuseWhatIsIncomplete) {
  EXPECT_NE(circular_triads(Values{0, 1, 0, 0}, 2).reason(), "");
  EXPECT_EQ(circular_triads(Values{0, 1, 1, 0, 0, 0, 0, 0, 0}, 3).reason(),
            "items 2 and 3 were not compared exactly once");
  EXPECT_NE(circular_triads(Values{0, 1, 1, 1, 0, 1, 0, 0, 0}, 3).reason(), "") << "both won";
  EXPECT_NE(circular_triads(Values{0, 2, 1, 0, 0, 1, 0, 0, 0}, 3).reason(), "") << "answered twice";
  EXPECT_THROW(circular_triads(Values{0, 1}, 3), std::invalid_argument);
}

TEST(GroupTriads, SumOfAllParticipants) {
  uniformity::Draws draws(5);
  std::vector<stats::CircularTriads> people;
  double triads = 0;
  for (int i = 0; i < 26; ++i) {
    people.push_back(*circular_triads(tournament(5, draws), 5));
    triads += people.back().triads;
  }
  const auto got = stats::group_triads(people);
  ASSERT_TRUE(got) << got.reason();
  EXPECT_EQ(got->participants, 26);
  EXPECT_EQ(got->triads, triads);
  EXPECT_EQ(got->expected, 65);
  // For a group of one participant, p is that of the participant's own test.
  const auto one = stats::group_triads(std::vector(people.begin(), people.begin() + 1));
  EXPECT_NEAR(one->p, people[0].p, 1e-15);
  EXPECT_NE(stats::group_triads({}).reason(), "");
  people.push_back(*circular_triads(tournament(6, draws), 6));
  EXPECT_NE(stats::group_triads(people).reason(), "");
}

TEST(GroupTriads, KeepTheirLevelAndFindAnOrder) {
  uniformity::Draws draws(6);
  const auto p = [&](double first_wins) {
    std::vector<stats::CircularTriads> people;
    for (int i = 0; i < 26; ++i) people.push_back(*circular_triads(tournament(5, draws, first_wins), 5));
    return stats::group_triads(people)->p;
  };
  int low = 0;
  for (int study = 0; study < 2000; ++study) low += p(0.5) <= 0.05;
  EXPECT_LE(low / 2000.0, 0.05 + 0.015);
  EXPECT_GE(low / 2000.0, 0.03) << "steps of the sum are small";
  EXPECT_LT(p(0.9), 1e-6);
}

}  // namespace
