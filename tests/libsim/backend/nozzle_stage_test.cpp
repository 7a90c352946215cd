/// The pass that moves particles into the jets, against brute force.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "libsim/solver/stages/stages.hpp"
#include "tests/libsim/backend/backend_test.hpp"

namespace sim::SIM_BACKEND {
namespace {

constexpr float edge = 2;
constexpr float tank = 10;

Nozzle nozzle() {
  Nozzle out;
  out.diameter_m = 1.8;
  out.position_m = {5, 4.5, 5};
  out.speed_m_s = 16;
  out.on_frames = 2;
  out.off_frames = 1;
  return out;
}

struct Start {
  std::vector<Vec4> position;
  std::vector<int> id;
};

/// Many particles have exactly the same height, so that ids decide.
Start pool(int n) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> at(0, tank);
  std::uniform_int_distribution<int> step(0, 40);
  Start out;
  for (int i = 0; i < n; ++i) {
    out.position.push_back({at(random), 0.05f * static_cast<float>(step(random)), at(random), 0.3f});
    out.id.push_back(i);
  }
  std::shuffle(out.id.begin(), out.id.end(), random);
  return out;
}

FluidState state_of(const Start& start) {
  FluidState state;
  auto& p = state.particles;
  p.allocate(all_columns(), static_cast<int>(start.position.size()));
  p.all().position.from_host(start.position);
  p.all().id.from_host(start.id);
  p.all().velocity.zero();
  p.all().level.zero();
  state.supports = level_supports(0.3);
  state.jets.nozzles = {nozzle()};
  state.jets.before.resize(1);
  state.jets.finest_spacing_m = 0.15;
  state.jets.frame_dt_s = 1.0 / 60;
  state.jets.corners = {{0, 0, 0}, {tank, 0, tank}, edge};
  return state;
}

bool in_corner(const Vec4& p) {
  return (p.x < edge || p.x > tank - edge) && (p.z < edge || p.z > tank - edge);
}

/// Ids of the `count` lowest particles in the corners.
std::vector<int> lowest(const Start& start, std::size_t count) {
  std::vector<std::pair<float, int>> found;
  for (std::size_t i = 0; i < start.id.size(); ++i) {
    if (in_corner(start.position[i])) found.emplace_back(start.position[i].y, start.id[i]);
  }
  std::sort(found.begin(), found.end());
  std::vector<int> out;
  for (std::size_t i = 0; i < std::min(count, found.size()); ++i) out.push_back(found[i].second);
  std::sort(out.begin(), out.end());
  return out;
}

/// Ids of the particles that the pass moved into the jet.
std::vector<int> moved(const FluidState& state) {
  const auto velocity = state.particles.all().velocity.to_host();
  const auto id = state.particles.all().id.to_host();
  std::vector<int> out;
  for (std::size_t i = 0; i < id.size(); ++i) {
    if (velocity[i].y != 0) out.push_back(id[i]);
  }
  std::sort(out.begin(), out.end());
  return out;
}

SIM_TEST(NozzleStage, TakesTheLowestCornerWaterTiesById) {
  const Start start = pool(20'000);
  FluidState state = state_of(start);
  nozzle_stage().run(state);
  const auto due = layers_due(nozzle(), 0.15, {}, 0, 1.0 / 60);
  ASSERT_EQ(due.count, 2);
  const auto sites = static_cast<std::size_t>(jet_layer(nozzle(), 0.15).sites);
  EXPECT_EQ(sites, 113u);
  EXPECT_EQ(moved(state), lowest(start, 2 * sites));
  EXPECT_EQ(state.jets.poured, static_cast<std::int64_t>(2 * sites));
  EXPECT_EQ(state.jets.waited, 0u);
}

SIM_TEST(NozzleStage, ChoiceAndPlacesDoNotDependOnTheOrderInMemory) {
  Start start = pool(20'000);
  FluidState first = state_of(start);
  nozzle_stage().run(first);
  std::vector<std::size_t> order(start.id.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(8));
  Start shuffled;
  for (const auto i : order) {
    shuffled.position.push_back(start.position[i]);
    shuffled.id.push_back(start.id[i]);
  }
  FluidState second = state_of(shuffled);
  nozzle_stage().run(second);
  const auto a = first.particles.all().position.to_host();
  const auto b = second.particles.all().position.to_host();
  for (std::size_t i = 0; i < order.size(); ++i) {
    ASSERT_EQ(a[order[i]].x, b[i].x);
    ASSERT_EQ(a[order[i]].y, b[i].y);
    ASSERT_EQ(a[order[i]].z, b[i].z);
  }
}

SIM_TEST(Exchange, NothingIsKnownOfWhatItPours) {
  FluidState state = state_of(pool(8));
  auto& p = state.particles.all();
  p.saliency.from_host(std::vector<float>(8, 0.7f));
  p.unrest.from_host(std::vector<float>(8, 0.4f));
  Array<int> lowest;
  lowest.from_host({5, 2, 0});
  std::int64_t reservoir = 0;
  EXPECT_EQ(Exchange().run(state.particles, state.supports, lowest.data(), 3, 3, 1, 0, reservoir, nullptr),
            1);
  using testing::ElementsAre;
  EXPECT_THAT(p.saliency.to_host(), ElementsAre(0.7f, 0.7f, 0.7f, 0.7f, 0.7f, 0, 0, 0));
  EXPECT_THAT(p.unrest.to_host(), ElementsAre(0.4f, 0.4f, 0.4f, 0.4f, 0.4f, 0, 0, 0));
}

SIM_TEST(NozzleStage, LayersPassTheMouthOnTimeAtTheNozzlesSpeed) {
  FluidState state = state_of(pool(20'000));
  nozzle_stage().run(state);
  const auto due = layers_due(nozzle(), 0.15, {}, 0, 1.0 / 60);
  const auto position = state.particles.all().position.to_host();
  const auto velocity = state.particles.all().velocity.to_host();
  std::vector<int> of_layer(2);
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (velocity[i].y == 0) continue;
    // The particle falls freely from the mouth.
    const double speed = -static_cast<double>(velocity[i].y);
    const double lead = (16 - speed) / 9.81;
    EXPECT_NEAR(static_cast<double>(position[i].y) - speed * lead - 4.905 * lead * lead, 4.5, 1e-5);
    const double layer = (lead - due.first_time_s) / due.interval_s;
    EXPECT_NEAR(layer, std::round(layer), 1e-3);
    ++of_layer.at(static_cast<std::size_t>(std::lround(layer)));
    EXPECT_LT(std::hypot(static_cast<double>(position[i].x) - 5, static_cast<double>(position[i].z) - 5),
              0.9);
    EXPECT_EQ(position[i].w, 0.3f);
  }
  EXPECT_EQ(of_layer, (std::vector<int>{113, 113}));
}

SIM_TEST(NozzleStage, WaitsWhenTheCornersHoldTooFew) {
  Start start = pool(20'000);
  // Leaves only one layer's particles and a few more in the corners.
  int kept = 0;
  for (auto& p : start.position) {
    if (in_corner(p) && ++kept > 120) p.x = p.z = 5;
  }
  FluidState state = state_of(start);
  nozzle_stage().run(state);
  EXPECT_EQ(state.jets.poured, 113);
  EXPECT_EQ(state.jets.waited, 1u);
  for (auto& p : start.position) p.x = p.z = 5;
  FluidState dry = state_of(start);
  nozzle_stage().run(dry);
  EXPECT_EQ(dry.jets.poured, 0);
  EXPECT_EQ(dry.jets.waited, 2u);
  FluidState empty = state_of({});
  nozzle_stage().run(empty);
  EXPECT_EQ(empty.jets.waited, 2u);
}

SIM_TEST(NozzleStage, NeverTakesAParticleThatIsNotFinite) {
  Start start = pool(2'000);
  start.position[7] = {0.1f, std::nanf(""), 0.1f, 0.3f};
  FluidState state = state_of(start);
  nozzle_stage().run(state);
  EXPECT_EQ(state.particles.all().velocity.to_host()[7].y, 0);
}

SIM_TEST(NozzleStage, RestsBetweenPulsesWithoutAnyMemory) {
  FluidState state = state_of(pool(2'000));
  state.jets.frame = 2;
  nozzle_stage().run(state);
  EXPECT_TRUE(moved(state).empty());
  EXPECT_EQ(state.jets.columns.bytes(), 0u);
}

/// A pool of mixed levels whose particles have the target level `target`, with capacity for eight times as
/// many.
FluidState mixed_pool(int n, int target, std::int64_t& mass) {
  Start start = pool(n);
  FluidState state;
  auto& p = state.particles;
  p.allocate(all_columns(), n, 8 * n);
  state.supports = level_supports(0.3);
  std::vector<std::uint8_t> level(start.id.size());
  mass = 0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    level[i] = static_cast<std::uint8_t>(i % 4);
    start.position[i].w = state.supports.h[i % 4];
    mass += 1 << (i % 4);
  }
  // A particle near the mouth, where the pass reads the target.
  start.position[0] = {5, 4.4f, 5, state.supports.h[0]};
  p.all().position.from_host(start.position);
  p.all().id.from_host(start.id);
  p.all().level.from_host(level);
  p.all().target.from_host(std::vector<std::uint8_t>(start.id.size(), static_cast<std::uint8_t>(target)));
  p.all().velocity.zero();
  state.one_level = false;
  state.jets.nozzles = {nozzle()};
  state.jets.before.resize(1);
  state.jets.finest_spacing_m = 0.15;
  state.jets.frame_dt_s = 1.0 / 60;
  state.jets.corners = {{0, 0, 0}, {tank, 0, tank}, edge};
  state.jets.by_target = true;
  return state;
}

SIM_TEST(NozzleStage, PoursTheMedianTargetAndKeepsTheMassExactly) {
  for (int target = 0; target < 4; ++target) {
    std::int64_t mass = 0;
    FluidState state = mixed_pool(8'000, target, mass);
    const auto before = moved(state).size();
    ASSERT_EQ(before, 0u);
    for (int frame = 0; frame < 2; ++frame) {
      state.jets.frame = frame;
      nozzle_stage().run(state);
      const auto level = state.particles.all().level.to_host();
      const auto position = state.particles.all().position.to_host();
      const auto velocity = state.particles.all().velocity.to_host();
      auto id = state.particles.all().id.to_host();
      std::int64_t domain = 0;
      std::int64_t poured = 0;
      for (std::size_t i = 0; i < level.size(); ++i) {
        domain += 1 << level[i];
        ASSERT_EQ(position[i].w, state.supports.h[level[i]]);
        if (velocity[i].y == 0) continue;
        ASSERT_EQ(level[i], target);
        poured += 1 << level[i];
      }
      EXPECT_EQ(domain + state.jets.reservoir, mass);
      EXPECT_GE(state.jets.reservoir, 0);
      EXPECT_LT(state.jets.reservoir, 8);
      EXPECT_EQ(poured, state.jets.poured);
      EXPECT_GT(poured, 0);
      std::sort(id.begin(), id.end());
      EXPECT_EQ(std::adjacent_find(id.begin(), id.end()), id.end()) << "ids are unique";
      EXPECT_LT(id.back(), state.particles.capacity());
    }
    EXPECT_EQ(state.jets.waited, 0u);
  }
}

SIM_TEST(NozzleStage, WaitsWhenTheCapacityIsReached) {
  // The corners hold only the coarsest particles, the layers need the finest, and there is no capacity for
  // the splits.
  Start start = pool(4'000);
  FluidState state = state_of(start);
  state.one_level = false;
  state.particles.all().level.from_host(std::vector<std::uint8_t>(start.id.size(), 3));
  nozzle_stage().run(state);
  EXPECT_EQ(state.jets.waited, 2u);
  EXPECT_EQ(state.jets.poured, 0);
  EXPECT_EQ(state.jets.reservoir, 0);
  EXPECT_EQ(state.particles.size(), 4'000);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
