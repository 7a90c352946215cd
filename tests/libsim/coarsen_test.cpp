#include "libsim/levels/coarsen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

namespace {

using sim::ParticleState;

std::vector<ParticleState> cloud(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(0, 5);
  std::uniform_real_distribution<float> speed(-3, 3);
  std::vector<ParticleState> out;
  for (int i = 0; i < n; ++i)
    out.push_back({i, 0, at(random), at(random), at(random), speed(random), speed(random), speed(random)});
  return out;
}

std::vector<std::uint8_t> random_targets(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> out(n);
  for (auto& target : out)
    target = static_cast<std::uint8_t>(std::min(3u, static_cast<unsigned>(random() % 9)));
  return out;
}

int units(const std::vector<ParticleState>& state) {
  int sum = 0;
  for (const auto& p : state) sum += 1 << p.level;
  return sum;
}

bool same(const std::vector<ParticleState>& a, const std::vector<ParticleState>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.id == q.id && p.level == q.level && p.x_m == q.x_m && p.y_m == q.y_m && p.z_m == q.z_m &&
           p.vx_m_s == q.vx_m_s && p.vy_m_s == q.vy_m_s && p.vz_m_s == q.vz_m_s;
  });
}

TEST(Coarsen, TargetsOfThreeLeaveExactlyAnEighth) {
  // Counts for which n / 8 is a power of two, and others.
  for (const int eighths : {0, 1, 2, 3, 5, 7, 100, 513}) {
    const auto fine = cloud(8 * eighths, 1);
    const auto coarse = sim::coarsen(fine, std::vector<std::uint8_t>(fine.size(), 3));
    ASSERT_EQ(coarse.size(), static_cast<std::size_t>(eighths));
    for (const auto& p : coarse) ASSERT_EQ(p.level, 3);
  }
}

TEST(Coarsen, TargetsOfZeroChangeNothing) {
  const auto fine = cloud(800, 2);
  EXPECT_TRUE(same(sim::coarsen(fine, std::vector<std::uint8_t>(fine.size(), 0)), fine));
}

TEST(Coarsen, KeepsMassMomentumAndCentreOfMass) {
  const auto fine = cloud(4096, 3);
  const auto coarse = sim::coarsen(fine, random_targets(fine.size(), 4));
  EXPECT_EQ(units(coarse), 4096);
  EXPECT_LT(coarse.size(), fine.size());
  double before[4] = {};
  double after[4] = {};
  const auto add = [](double* sum, const ParticleState& p) {
    const double m = 1 << p.level;
    sum[0] += m * static_cast<double>(p.x_m);
    sum[1] += m * static_cast<double>(p.y_m);
    sum[2] += m * static_cast<double>(p.vx_m_s);
    sum[3] += m * static_cast<double>(p.vz_m_s);
  };
  for (const auto& p : fine) add(before, p);
  for (const auto& p : coarse) add(after, p);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(after[k], before[k], 1e-2) << k;  // sums are of the order of 1e4
}

TEST(Coarsen, NeverMergesBeyondATarget) {
  // One particle with target 0 among coarse targets stays, so its leaf of eight merges only to 1 + 1 + 2 + 4.
  const auto fine = cloud(1024, 5);
  std::vector<std::uint8_t> targets(fine.size(), 3);
  targets[77] = 0;
  const auto coarse = sim::coarsen(fine, targets);
  EXPECT_EQ(coarse.size(), 1024u / 8 + 3);
  std::map<int, int> by_level;
  for (const auto& p : coarse) ++by_level[p.level];
  EXPECT_EQ(by_level, (std::map<int, int>{{0, 2}, {1, 1}, {2, 1}, {3, 127}}));
  const auto kept = std::find_if(coarse.begin(), coarse.end(), [](const auto& p) { return p.id == 77; });
  ASSERT_NE(kept, coarse.end());
  EXPECT_EQ(kept->level, 0);
  EXPECT_EQ(kept->x_m, fine[77].x_m);
}

TEST(Coarsen, LeavesOfALatticeAreItsCubes) {
  std::vector<ParticleState> fine;
  for (int i = 0; i < 512; ++i) {
    fine.push_back({i, 0, static_cast<float>(i % 8), static_cast<float>(i / 8 % 8),
                    static_cast<float>(i / 64), 0, 0, 0});
  }
  for (const auto& p : sim::coarsen(fine, std::vector<std::uint8_t>(512, 3))) {
    for (const float x : {p.x_m, p.y_m, p.z_m}) EXPECT_EQ(std::fmod(x, 2.0f), 0.5f);
  }
}

TEST(Coarsen, DoesNotDependOnTheOrderOfTheInput) {
  auto fine = cloud(2048, 6);
  // Many equal coordinates: ids must decide.
  for (auto& p : fine) p.x_m = std::floor(p.x_m);
  const auto targets = random_targets(fine.size(), 7);
  const auto first = sim::coarsen(fine, targets);
  std::vector<std::size_t> order(fine.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(9));
  std::vector<ParticleState> shuffled;
  std::vector<std::uint8_t> wishes;
  for (const auto i : order) {
    shuffled.push_back(fine[i]);
    wishes.push_back(targets[i]);
  }
  EXPECT_TRUE(same(sim::coarsen(shuffled, wishes), first));
}

TEST(Coarsen, RefusesWhatItCannotTake) {
  auto fine = cloud(16, 8);
  const std::vector<std::uint8_t> targets(16, 3);
  EXPECT_THROW(sim::coarsen(std::span(fine).first(15), std::span(targets).first(15)), std::invalid_argument);
  EXPECT_THROW(sim::coarsen(fine, std::span(targets).first(8)), std::invalid_argument);
  EXPECT_THROW(sim::coarsen(fine, std::vector<std::uint8_t>(16, 4)), std::invalid_argument);
  fine[3].level = 1;
  EXPECT_THROW(sim::coarsen(fine, targets), std::invalid_argument);
  fine[3].level = 0;
  fine[3].y_m = std::nanf("");
  EXPECT_THROW(sim::coarsen(fine, targets), std::invalid_argument);
}

}  // namespace
