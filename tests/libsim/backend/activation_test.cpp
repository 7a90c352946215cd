/// Temporal acceleration piece by piece: the random choice of the particles to solve against its
/// probabilities, the importance from which these follow, and the velocity changes that unsolved particles
/// inherit.

#include "libsim/activation/importance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tests/libsim/backend/drops.hpp"

namespace sim::SIM_BACKEND {
namespace {

/// The state before a frame chooses its active particles; the grid has the mean velocities and energies of
/// the drops.
FluidState ready(const std::vector<Drop>& all, float beta) {
  auto state = state_of(all);
  auto& a = state.activation;
  a.grid.fit(state.domain, 5 * h);
  update_velocity(a.grid, state);
  a.grid.update_energy(MovingView(state.particles));
  a.columns_set = true;  // else the stage discards the grid's values
  a.beta = beta;
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

SIM_TEST(Activation, AFrameOfOneSubstepSolvesAll) {
  auto state = ready(drops(500, 2), 0.1f);
  state.parameters.substeps = 1;
  activation_stage().run(state);
  EXPECT_TRUE(state.all_active);
  EXPECT_FALSE(state.activation.rests_within_frame());
}

SIM_TEST(Activation, EverySecondSubstepSolvesAllAndTheLastOneDoes) {
  auto state = ready(drops(500, 2), 0.1f);
  for (const int substeps : {2, 3, 4, 5}) {
    state.parameters.substeps = substeps;
    activation_stage().run(state);
    for (int k = 0; k < substeps; ++k) {
      state.begin_substep(k);
      EXPECT_EQ(state.all_active, (substeps - k) % 2 == 1) << k << " of " << substeps;
      EXPECT_EQ(state.after_rest(), state.all_active && k > 0) << k << " of " << substeps;
    }
    velocity_grid_stage().run(state);
    EXPECT_FALSE(state.activation.rests_within_frame());
  }
  state.activation.rules.within_frame = false;
  activation_stage().run(state);
  for (int k = 0; k < 5; ++k) {
    state.begin_substep(k);
    EXPECT_FALSE(state.all_active);
    EXPECT_FALSE(state.after_rest());
  }
}

SIM_TEST(Activation, FastAndNewParticlesAreSolved) {
  auto all = drops(4000, 6);
  for (auto& drop : all) drop.v = {0.01f * drop.v.x, 0, 0};
  auto state = ready(all, 0.02f);
  auto& p = state.particles;
  auto velocity = p.all().velocity.to_host();
  auto age = p.all().age.to_host();
  for (std::size_t i = 0; i < 200; ++i) {
    velocity[i].y = 100;
    age[i + 200] = 0;
  }
  p.all().age.from_host(age);
  p.all().velocity.from_host(velocity);
  for (const bool within_frame : {true, false}) {
    state.activation.rules.within_frame = within_frame;
    activation_stage().run(state);
    const auto active = p.all().active.to_host();
    EXPECT_EQ(std::count(active.begin(), active.begin() + 400, 0) == 0, within_frame);
    EXPECT_GT(std::count(active.begin() + 400, active.end(), 0), 500);
    velocity_grid_stage().run(state);
  }
}

SIM_TEST(Activation, UnknownPlacesAreSolved) {
  auto state = state_of(drops(1000, 6));
  state.activation.beta = 0.02f;
  activation_stage().run(state);  // the grid is still empty
  for (const auto active : state.particles.all().active.to_host()) EXPECT_EQ(active, 1);
}

/// The test changes the velocity of solved particles by `gain`. The stage must give resting particles the
/// same change, so that all end with the same velocity. Those that rested for the whole frame also move.
void takes_the_change(bool within_frame) {
  auto all = drops(20000, 9);
  for (auto& drop : all) drop.v = {1, 2, 3};
  auto state = ready(all, 0.4f);
  state.activation.rules.within_frame = within_frame;
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
  // The frame has 3 substeps of 1/180 s with an equal change of the velocity in each. The mean velocity over
  // the substeps includes 2/3 of the whole change, which gives the displacement.
  const float way = within_frame ? 0 : 2.0f / 3 / 60;
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
SIM_TEST(EndOfRest, WithinTheFrameGivesTheChangeOfTheCell) { takes_the_change(true); }
SIM_TEST(EndOfRest, OfTheWholeFrameGivesTheVelocityOfTheCell) { takes_the_change(false); }

/// Resting particles already gained a part of the change: they get the rest of it.
SIM_TEST(EndOfRest, GivesOnlyWhatIsMissing) {
  auto all = drops(20000, 9);
  for (auto& drop : all) drop.v = {1, 0, 0};
  auto state = ready(all, 0.4f);
  activation_stage().run(state);
  auto& p = state.particles;
  auto velocity = p.all().velocity.to_host();
  const auto active = p.all().active.to_host();
  for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i].y = active[i] ? 0.5f : 0.2f;
  p.all().velocity.from_host(velocity);
  velocity_grid_stage().run(state);
  const auto after = p.all().velocity.to_host();
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_NEAR(after[i].y, 0.5f, 1e-5f) << i;
}

/// A particle that rested in the substep before gets half of the velocity that the projections' displacement
/// gives others, because it stands for two substeps. The coarse pressure acts in each substep and counts in
/// full.
SIM_TEST(EndOfRest, CorrectionsCountOverTwoSubsteps) {
  auto state = ready(drops(1000, 9), 0.4f);
  state.parameters.most_speed = 1000;
  state.parameters.substeps = 2;
  activation_stage().run(state);
  state.begin_substep(1);
  ASSERT_TRUE(state.after_rest());
  auto& p = state.particles.all();
  const float dt = state.parameters.dt;
  const auto position = p.position.to_host();
  const auto before = p.velocity.to_host();
  auto predicted = position;
  for (std::size_t i = 0; i < predicted.size(); ++i)
    predicted[i] = with_w(xyz(position[i]) + dt * (xyz(before[i]) + Vec3{0.25f, 0, 0}), position[i].w);
  p.predicted.from_host(predicted);
  before_projections_stage().run(state);
  for (Vec4& x : predicted) x.y += dt;
  p.predicted.from_host(predicted);
  velocity_stage().run(state);
  const auto active = p.active.to_host();
  const auto after = p.velocity.to_host();
  int resting = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    resting += !active[i];
    EXPECT_NEAR(after[i].x - before[i].x, 0.25f, 2e-3f);
    EXPECT_NEAR(after[i].y - before[i].y, active[i] ? 1 : 0.5f, 2e-3f);
  }
  EXPECT_GT(resting, 100);
}

SIM_TEST(Importance, IsEquation12To14OnALinearFlow) {
  // One particle in the centre of each cell, with v = 2 k along x in the cells of column k: |dV| = 2 in every
  // cell, dV/dl = 0.
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
    const float energy = v * v;  // 2 v^2 / 2, because a particle of level 1 has two units of mass
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
