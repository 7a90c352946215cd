/// Sums and means of velocities on cells, against brute force.

#include "libsim/activation/velocity_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/libsim/backend/drops.hpp"

namespace sim::SIM_BACKEND {
namespace {

struct Momentum {
  double mass = 0;
  std::array<double, 3> of{};
};

/// Momentum by level and cell, of the drops that `who` selects, in the cells that `cell_of` returns.
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
  // A particle's momentum is truncated to whole units of 2^-20 m_* m/s (m_*: mass of a particle of level 0).
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
  std::vector<std::uint8_t> active(all.size());
  std::vector<int> start(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    active[i] = static_cast<std::uint8_t>(i % 7 % 2);
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
  // Two measurements with different selections: nothing of the first may remain in the second.
  sums.measure(view, p.active.data(),
               {{Whose::All, fine.frame()}, {}, {Whose::Resting, coarse.frame(), p.start_cell.data()}});
  expect_momentum(sums.of(0), momentum_of(all, of_fine, everyone, cell_in(fine)));
  EXPECT_EQ(sums.of(1), nullptr);
  expect_momentum(sums.of(2), momentum_of(all, of_coarse, resting, from_start));
  sums.measure(view, p.active.data(),
               {{Whose::Solved, coarse.frame(), p.start_cell.data()},
                {Whose::Resting, fine.frame(), p.start_cell.data()},
                {Whose::Solved, fine.frame()}});
  expect_momentum(sums.of(0), momentum_of(all, of_coarse, solved, from_start));
  expect_momentum(sums.of(1), momentum_of(all, of_fine, resting, from_start));
  expect_momentum(sums.of(2), momentum_of(all, of_fine, solved, cell_in(fine)));
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
  grid.update_energy(MovingView(state.particles));  // clears the first sums
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
  // A corner without a value is ignored; if all lack one, the result is value_unknown.
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

}  // namespace
}  // namespace sim::SIM_BACKEND
