/// Temporal acceleration piece by piece: grids against brute force, the choice against its probabilities.

#include "libsim/activation/importance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

constexpr float h = 0.3f;  // h_*; d_* = 0.15 m, cells of 1.5 m

struct Drop {
  Vec3 x, v;
  int id, level;
};

std::vector<Drop> drops(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(0, 6);
  std::uniform_real_distribution<float> speed(-4, 4);
  std::vector<Drop> out;
  for (int i = 0; i < n; ++i) {
    out.push_back(
        {{at(random), at(random), at(random)}, {speed(random), speed(random), speed(random)}, i, i % 4});
  }
  return out;
}

FluidState state_of(const std::vector<Drop>& drops) {
  FluidState state;
  state.guards.resize(1);
  state.guards.zero();
  state.finest_support = h;
  state.domain = {{0, 0, 0}, {6, 4.5f, 6}};  // 4 x 3 x 4 cells; some drops lie above
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(drops.size()));
  std::vector<Vec4> position;
  std::vector<Vec4> velocity;
  std::vector<int> id;
  std::vector<std::uint8_t> level;
  for (const auto& drop : drops) {
    position.push_back(with_w(drop.x, h * std::cbrt(static_cast<float>(1 << drop.level))));
    velocity.push_back(with_w(drop.v, 0));
    id.push_back(drop.id);
    level.push_back(static_cast<std::uint8_t>(drop.level));
  }
  p.all().position.from_host(position);
  p.all().predicted.from_host(position);
  p.all().velocity.from_host(velocity);
  p.all().id.from_host(id);
  p.all().level.from_host(level);
  p.all().age.from_host(std::vector<std::uint8_t>(drops.size(), 255));
  p.all().active.from_host(std::vector<std::uint8_t>(drops.size(), 1));
  p.all().rest.zero();
  p.all().saliency.zero();
  p.all().density.from_host(std::vector<float>(drops.size(), 1));
  return state;
}

/// V of all particles.
void update_velocity(VelocityGrid& grid, FluidState& state) {
  CellMomentum sums;
  sums.measure(MovingView(state.particles), nullptr, {{Whose::All, grid.frame()}});
  for_each_pass("mean velocity", grid.finish_velocity(sums.of(0)));
}

struct Momentum {
  double mass = 0;
  std::array<double, 3> of{};
};

/// By level and cell: of the drops that `who` takes, in the cells that cell_of tells.
template <class Who, class CellOf>
std::vector<Momentum> momentum_of(const std::vector<Drop>& all, std::size_t cells, Who who, CellOf cell_of) {
  std::vector<Momentum> out(4 * cells);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!who(i)) continue;
    Momentum& sum = out[static_cast<std::size_t>(all[i].level) * cells + cell_of(i)];
    const double m = 1 << all[i].level;
    const Vec3 v = all[i].v;
    const double parts[3] = {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    sum.mass += m;
    for (std::size_t k = 0; k < 3; ++k) sum.of[k] += m * parts[k];
  }
  return out;
}

void expect_momentum(const MomentumSum* sums, const std::vector<Momentum>& expected) {
  ASSERT_NE(sums, nullptr);
  std::vector<MomentumSum> found(expected.size());
  copy_to_host(found.data(), sums, found.size() * sizeof(MomentumSum));
  // A particle's momentum is cut to whole units of 2^-20 m/s.
  const auto near = [](std::uint64_t sum, double momentum, double mass) {
    EXPECT_NEAR(static_cast<double>(static_cast<std::int64_t>(sum)) / 1048576, momentum, mass / 1048576);
  };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(static_cast<double>(found[i].mass), expected[i].mass) << i;
    near(found[i].x, expected[i].of[0], expected[i].mass);
    near(found[i].y, expected[i].of[1], expected[i].mass);
    near(found[i].z, expected[i].of[2], expected[i].mass);
  }
}

SIM_TEST(CellMomentum, HoldWhoseTheyAreByTheirOwnCells) {
  const auto all = drops(3000, 4);
  auto state = state_of(all);
  // 0 rests, 1 is solved, 2 is solved apart.
  std::vector<std::uint8_t> active(all.size());
  std::vector<int> start(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    active[i] = static_cast<std::uint8_t>(i % 7 % 3);
    start[i] = static_cast<int>(i % 5);
  }
  auto& p = state.particles.all();
  p.active.from_host(active);
  p.start_cell.from_host(start);
  VelocityGrid coarse;
  VelocityGrid fine;
  coarse.fit(state.domain, 5 * h);
  fine.fit(state.domain, 2 * h);
  const auto cell_in = [&](const VelocityGrid& grid) {
    return [&, frame = grid.frame()](std::size_t i) {
      return static_cast<std::size_t>(frame.cell_of(all[i].x));
    };
  };
  const auto from_start = [&](std::size_t i) { return static_cast<std::size_t>(start[i]); };
  const auto everyone = [](std::size_t) { return true; };
  const auto solved = [&](std::size_t i) { return active[i] == 1; };
  const auto resting = [&](std::size_t i) { return active[i] == 0; };
  const auto of_coarse = static_cast<std::size_t>(coarse.cells());
  const auto of_fine = static_cast<std::size_t>(fine.cells());
  CellMomentum sums;
  const MovingView view(state.particles);
  // Twice, in other places: nothing is left of the first time.
  sums.measure(view, p.active.data(),
               {{Whose::All, fine.frame()}, {}, {Whose::Resting, coarse.frame(), p.start_cell.data()}});
  expect_momentum(sums.of(0), momentum_of(all, of_fine, everyone, cell_in(fine)));
  EXPECT_EQ(sums.of(1), nullptr);
  expect_momentum(sums.of(2), momentum_of(all, of_coarse, resting, from_start));
  EXPECT_EQ(sums.of(3), nullptr);
  sums.measure(view, p.active.data(),
               {{Whose::Solved, coarse.frame(), p.start_cell.data()},
                {Whose::Resting, fine.frame(), p.start_cell.data()},
                {Whose::All, coarse.frame()},
                {Whose::Solved, fine.frame()}});
  expect_momentum(sums.of(0), momentum_of(all, of_coarse, solved, from_start));
  expect_momentum(sums.of(1), momentum_of(all, of_fine, resting, from_start));
  expect_momentum(sums.of(2), momentum_of(all, of_coarse, everyone, cell_in(coarse)));
  expect_momentum(sums.of(3), momentum_of(all, of_fine, solved, cell_in(fine)));
  sums.measure(view, nullptr, {{Whose::All, coarse.frame()}});
  expect_momentum(sums.of(0), momentum_of(all, of_coarse, everyone, cell_in(coarse)));
  EXPECT_EQ(sums.of(1), nullptr);
}

SIM_TEST(VelocityGrid, MeansEqualBruteForce) {
  const auto all = drops(3000, 3);
  auto state = state_of(all);
  VelocityGrid grid;
  grid.fit(state.domain, 5 * h);
  const CellBlock block = grid.frame().block;
  ASSERT_EQ(block.nx, 4);
  ASSERT_EQ(block.ny, 3);
  ASSERT_EQ(block.nz, 4);
  update_velocity(grid, state);
  grid.update_energy(MovingView(state.particles));
  grid.update_energy(MovingView(state.particles));  // nothing is left of the first time
  const auto cells = static_cast<std::size_t>(grid.cells());
  std::vector<double> mass(4 * cells);
  std::vector<std::array<double, 3>> momentum(4 * cells);
  std::vector<double> energy(cells);
  for (const auto& drop : all) {
    const auto at = [](float x, int n) {
      return std::clamp(static_cast<int>(std::floor(x / 1.5f)), 0, n - 1);
    };
    const auto cell =
        static_cast<std::size_t>(block.index(at(drop.x.x, 4), at(drop.x.y, 3), at(drop.x.z, 4)));
    const std::size_t place = static_cast<std::size_t>(drop.level) * cells + cell;
    const double m = 1 << drop.level;
    const double v[3] = {static_cast<double>(drop.v.x), static_cast<double>(drop.v.y),
                         static_cast<double>(drop.v.z)};
    mass[place] += m;
    for (std::size_t k = 0; k < 3; ++k) {
      momentum[place][k] += m * v[k];
      energy[cell] += m * v[k] * v[k] / 2;
    }
  }
  const auto velocity = grid.velocity().to_host();
  const auto measured_energy = grid.energy().to_host();
  for (std::size_t i = 0; i < 4 * cells; ++i) {
    ASSERT_GT(mass[i], 0);
    EXPECT_EQ(velocity[i].w, value_measured);
    EXPECT_NEAR(velocity[i].x, momentum[i][0] / mass[i], 1e-5);
    EXPECT_NEAR(velocity[i].y, momentum[i][1] / mass[i], 1e-5);
    EXPECT_NEAR(velocity[i].z, momentum[i][2] / mass[i], 1e-5);
  }
  for (std::size_t c = 0; c < cells; ++c) EXPECT_NEAR(measured_energy[c], energy[c], 1e-4 * energy[c] + 1e-2);
}

SIM_TEST(VelocityGrid, SamplesALinearFieldExactlyAndClampsAtTheBorders) {
  const GridFrame grid{{{1, 2, 3}, 1.5f}, {4, 3, 5}};
  std::vector<Vec4> values;
  for (int c = 0; c < grid.cells(); ++c) {
    values.push_back({static_cast<float>(c % 4), static_cast<float>(c / 4 % 3), static_cast<float>(c / 12),
                      value_measured});
  }
  Vec4 v = sample(values.data(), 0, grid.corners({1 + 1.5f * 2.25f, 2 + 1.5f * 1.5f, 3 + 1.5f * 3.5f}));
  EXPECT_NEAR(v.x, 1.75f, 1e-5f);
  EXPECT_NEAR(v.y, 1, 1e-5f);
  EXPECT_NEAR(v.z, 3, 1e-5f);
  v = sample(values.data(), 0, grid.corners({-9, 99, 3}));
  EXPECT_NEAR(v.x, 0, 1e-6f);
  EXPECT_NEAR(v.y, 2, 1e-6f);
  EXPECT_NEAR(v.z, 0, 1e-6f);
  // A corner without a value takes no part; none at all is told apart.
  for (auto& value : values) {
    if (value.x != 2) value.w = value_unknown;
  }
  EXPECT_NEAR(sample(values.data(), 0, grid.corners({1 + 1.5f * 2.25f, 3, 4})).x, 2, 1e-6f);
  EXPECT_EQ(sample(values.data(), 0, grid.corners({1.1f, 3, 4})).w, value_unknown);
}

SIM_TEST(VelocityGrid, FillsWhatIsEmptyFromTheFrameBeforeThenFromOtherLevels) {
  auto first = state_of({{{1, 1, 1}, {2, 0, 0}, 0, 0}, {{1, 1, 1}, {-1, 0, 0}, 1, 2}});
  auto second = state_of({{{1, 1, 1}, {-1, 0, 0}, 1, 2}});
  VelocityGrid grid;
  grid.fit(first.domain, 5 * h);
  const auto cells = static_cast<std::size_t>(grid.cells());
  const auto level = [&](std::size_t l) { return grid.velocity().to_host()[l * cells]; };
  update_velocity(grid, first);
  EXPECT_EQ(level(0).x, 2);
  EXPECT_EQ(level(1).x, -0.4f) << "level 1 is empty: (1 x 2 - 4 x 1) / 5";
  EXPECT_EQ(level(1).w, value_borrowed);
  update_velocity(grid, second);
  EXPECT_EQ(level(0).x, 2) << "of the frame before";
  EXPECT_EQ(level(0).w, value_borrowed);
  update_velocity(grid, second);
  EXPECT_EQ(level(0).x, -1) << "of the other level";
  EXPECT_EQ(grid.velocity().to_host()[cells - 1].w, value_unknown);
}

/// A state whose grid knows the drops' own velocities, before the frame's choice.
FluidState ready(const std::vector<Drop>& all, float beta) {
  auto state = state_of(all);
  auto& a = state.activation;
  a.grid.fit(state.domain, 5 * h);
  update_velocity(a.grid, state);
  a.grid.update_energy(MovingView(state.particles));
  a.beta = beta;
  a.rules.keep_fragile_active = false;
  return state;
}

SIM_TEST(Activation, ShareOfActiveParticlesFollowsTheProbabilities) {
  auto state = ready(drops(20000, 8), 0.3f);
  activation_stage().run(state);
  EXPECT_FALSE(state.all_active);
  double mean = 0;
  double variance = 0;
  double least = 1;
  double most = 0;
  const auto probability = state.activation.probability.to_host();
  for (const float p : probability) {
    mean += static_cast<double>(p);
    variance += static_cast<double>(p * (1 - p));
    least = std::min(least, static_cast<double>(p));
    most = std::max(most, static_cast<double>(p));
  }
  const auto active = state.particles.all().active.to_host();
  const double solved = std::accumulate(active.begin(), active.end(), 0.0);
  EXPECT_LT(std::abs(solved - mean), 4 * std::sqrt(variance));
  EXPECT_NEAR(least, 0.3, 1e-6);
  EXPECT_NEAR(most, 1, 1e-6);
  EXPECT_LT(mean / 20000, 0.8) << "the coarse ones dominate";
}

SIM_TEST(Activation, SameSeedChoosesTheSameParticlesWhateverTheirOrder) {
  auto all = drops(5000, 2);
  const auto chosen = [&](std::uint32_t seed) {
    auto state = ready(all, 0.4f);
    state.activation.seed = seed;
    activation_stage().run(state);
    const auto id = state.particles.all().id.to_host();
    const auto active = state.particles.all().active.to_host();
    std::vector<int> out(id.size());
    for (std::size_t i = 0; i < id.size(); ++i) out[static_cast<std::size_t>(id[i])] = active[i];
    return out;
  };
  const auto one = chosen(1);
  std::shuffle(all.begin(), all.end(), std::mt19937(4));
  EXPECT_EQ(one, chosen(1));
  EXPECT_NE(one, chosen(2));
}

SIM_TEST(Activation, WithBetaOneEveryoneIsSolved) {
  auto state = ready(drops(500, 2), 1);
  activation_stage().run(state);
  EXPECT_TRUE(state.all_active);
  for (const auto active : state.particles.all().active.to_host()) EXPECT_EQ(active, 1);
}

SIM_TEST(Activation, RestsAreNoLongerAndWorkNoShorterThanTheRulesAllow) {
  constexpr int never = 1000;
  for (const int most : {1, 3}) {
    for (const int least : {1, 2, 4}) {
      auto state = ready(drops(2000, 5), 0.05f);
      state.activation.rules.longest_rest = most;
      state.activation.rules.least_work = least;
      std::vector<int> rested(2000, 0);
      std::vector<int> worked(2000, never);
      int longest = 0;
      int shortest = never;
      for (std::uint32_t frame = 0; frame < 24; ++frame) {
        state.activation.frame = frame;
        activation_stage().run(state);
        const auto active = state.particles.all().active.to_host();
        for (std::size_t i = 0; i < active.size(); ++i) {
          if (!active[i] && rested[i] == 0) shortest = std::min(shortest, worked[i]);
          rested[i] = active[i] ? 0 : rested[i] + 1;
          worked[i] = active[i] ? std::min(worked[i] + 1, never) : 0;
          longest = std::max(longest, rested[i]);
        }
        velocity_grid_stage().run(state);
      }
      EXPECT_EQ(longest, most);
      EXPECT_EQ(shortest, least);
    }
  }
}

SIM_TEST(Activation, KeepsTheFragileActive) {
  // Slow drops far from the walls may rest; at a wall, fast, sparse, just made, or without a grid they may
  // not.
  auto all = drops(4000, 6);
  for (auto& drop : all) drop.v = {0.01f * drop.v.x, 0, 0};
  auto state = ready(all, 1);
  state.activation.rules.keep_fragile_active = true;
  state.walls.planes[state.walls.count++] = {{1, 0, 0}, 0};
  auto& p = state.particles;
  auto velocity = p.all().velocity.to_host();
  auto age = p.all().age.to_host();
  auto density = p.all().density.to_host();
  for (std::size_t i = 0; i < 200; ++i) {
    velocity[i].y = 100;
    age[i + 200] = 0;
    density[i + 400] = 0.3f;
  }
  p.all().age.from_host(age);
  p.all().density.from_host(density);
  activation_stage().run(state);
  velocity_grid_stage().run(state);  // notes who is sparse
  p.all().velocity.from_host(velocity);
  state.activation.beta = 0.02f;
  activation_stage().run(state);
  const auto active = p.all().active.to_host();
  const auto position = p.all().position.to_host();
  int resting = 0;
  for (std::size_t i = 0; i < active.size(); ++i) {
    const bool fragile = i < 600 || position[i].x < position[i].w;
    EXPECT_TRUE(active[i] || !fragile) << i;
    resting += !active[i];
  }
  EXPECT_GT(resting, 500);
}

SIM_TEST(Activation, UnknownPlacesAreSolved) {
  auto state = state_of(drops(1000, 6));
  state.activation.beta = 0.02f;
  state.activation.rules.keep_fragile_active = false;
  activation_stage().run(state);  // the grid has never seen a particle
  for (const auto active : state.particles.all().active.to_host()) EXPECT_EQ(active, 1);
}

/// Everyone's velocity changes by `gain` in the solve; the resting ones must come to the same.
void inherits(bool change) {
  auto all = drops(20000, 9);
  for (auto& drop : all) drop.v = {1, 2, 3};
  auto state = ready(all, 0.4f);
  state.activation.rules.inherit_change = change;
  activation_stage().run(state);
  const Vec3 gain{0.25f, -0.5f, 0};
  auto& p = state.particles;
  auto velocity = p.all().velocity.to_host();
  const auto active = p.all().active.to_host();
  const auto before = p.all().position.to_host();
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (active[i]) velocity[i] = with_w(xyz(velocity[i]) + gain, 0);
  }
  p.all().velocity.from_host(velocity);
  velocity_grid_stage().run(state);
  const auto after = p.all().velocity.to_host();
  const auto position = p.all().position.to_host();
  // A frame of 3 substeps of 1/180 s whose change comes in equal parts: 2/3 of it counts for the way.
  const float way = 2.0f / 3 / 60;
  int resting = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_NEAR(after[i].x, 1.25f, 1e-5f);
    EXPECT_NEAR(after[i].y, 1.5f, 1e-5f);
    EXPECT_NEAR(after[i].z, 3, 1e-5f);
    if (active[i]) continue;
    ++resting;
    EXPECT_NEAR(position[i].y - before[i].y, -0.5f * way, 1e-5f);
  }
  EXPECT_GT(resting, 1000);
}
SIM_TEST(Inherit, TheMeanChangeOfTheCell) { inherits(true); }
SIM_TEST(Inherit, TheMeanVelocityOfTheCell) { inherits(false); }

SIM_TEST(Importance, IsEquation12To14OnALinearFlow) {
  // One particle in each cell centre, v = (2 x, 0, 0) per cell: |dV| = 2 in every cell, dV/dl = 0.
  std::vector<Drop> all;
  for (int c = 0; c < 48; ++c) {
    const auto at = [](int k) { return 1.5f * (static_cast<float>(k) + 0.5f); };
    all.push_back({{at(c % 4), at(c / 4 % 3), at(c / 12)}, {2 * static_cast<float>(c % 4), 0, 0}, c, 1});
  }
  auto state = ready(all, 0.5f);
  measure_importance(state.activation, ImportanceView(state.particles), nullptr, 0.1f);
  const auto f = state.activation.importance.to_host();
  for (int x = 1; x < 3; ++x) {
    const float v = 2 * static_cast<float>(x);
    const float energy = v * v;  // 2 m_* v^2 / 2
    const float slope =
        (static_cast<float>((x + 1) * (x + 1)) - static_cast<float>((x - 1) * (x - 1))) * 4 / 2;
    const float expected = 2 * (2 / (v + 0.1f) + 2 / (v + 0.1f) + slope / (energy + 0.005f));
    EXPECT_NEAR(f[static_cast<std::size_t>(x)], expected, 1e-3f * expected);
  }
  Array<float> saliency;
  saliency.from_host(std::vector<float>(48, 1));
  measure_importance(state.activation, ImportanceView(state.particles), saliency.data(), 0.1f);
  EXPECT_NEAR(state.activation.importance.to_host()[1], 2.71828f * f[1], 1e-3f * f[1]);
}

SIM_TEST(ActiveSlots, ListTheActiveInOrderAndTheOthersBehind) {
  auto state = state_of(drops(1000, 1));
  auto& p = state.particles;
  auto active = p.all().active.to_host();
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = i % 3 != 1;
  p.all().active.from_host(active);
  state.activation.list_active(ActiveListView(p));
  const auto slots = state.activation.slots.to_host();
  std::vector<int> met(1000, 0);
  int last = -1;
  for (std::size_t s = 0; s < 1000; ++s) {
    const int i = slots[s] < 0 ? ~slots[s] : slots[s];
    ++met[static_cast<std::size_t>(i)];
    EXPECT_EQ(slots[s] >= 0, active[static_cast<std::size_t>(i)] == 1);
    EXPECT_EQ(slots[s] >= 0, s < 667) << s;
    if (slots[s] < 0) continue;
    EXPECT_GT(slots[s], last);
    last = slots[s];
  }
  EXPECT_EQ(std::count(met.begin(), met.end(), 1), 1000);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
