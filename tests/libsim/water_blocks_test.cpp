/// Scenes with several blocks of water.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libsim/scene/extent.hpp"
#include "libsim/scene/heat.hpp"
#include "libsim/solver/state_file.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::MethodKind;
using sim::WaterBlock;
using testing::AllOf;
using testing::HasSubstr;

sim::Scene tank_with(const std::vector<WaterBlock>& water) {
  auto scene = fluid_test::tank({2, 2, 1}, {1, 1, 1});
  scene.water = water;
  scene.v_ref_m_s = 5;
  return scene;
}

const WaterBlock pool{{0, 0, 0}, {2, 0.4, 1}};
const WaterBlock drop{{0.8, 0.9, 0.3}, {1.2, 1.3, 0.7}};

/// SingleDam with these lines in place of its block, after the keys of [water].
std::string dam_with_blocks(const std::string& blocks, bool gate = false) {
  std::string text = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("min_m = [0.0, 0.0, 0.0]\nmax_m = [9.6, 7.2, 12.8]\n", "");
  if (!gate) replace("gate = true", "gate = false");
  replace("[time]", blocks + "[time]");
  return text;
}
std::string block(const std::string& min, const std::string& max) {
  return "[[water.block]]\nmin_m = [" + min + "]\nmax_m = [" + max + "]\n";
}
const std::string low_block = block("0.0, 0.0, 0.0", "19.2, 2.0, 12.8");
const std::string high_block = block("8.0, 4.0, 4.0", "10.0, 6.0, 6.0");

TEST(WaterBlocks, AreReadFromASceneFile) {
  const auto scene = sim::parse_scene(dam_with_blocks(low_block + high_block), "scene.toml");
  ASSERT_EQ(scene.water.size(), 2u);
  EXPECT_EQ(scene.water[1].min_m, (sim::Vec3d{8, 4, 4}));
  EXPECT_EQ(scene.water[1].max_m, (sim::Vec3d{10, 6, 6}));
  EXPECT_NEAR(sim::water_volume_m3(scene), 19.2 * 2 * 12.8 + 8, 1e-9);
}

TEST(WaterBlocks, ErrorsNameBothBlocksAndTheMend) {
  const auto error = [](const std::string& blocks, bool gate = false) {
    return fluid_test::scene_error(dam_with_blocks(blocks, gate));
  };
  EXPECT_EQ(error(low_block + high_block), "no error");
  EXPECT_EQ(error(low_block + block("8.0, 2.0, 4.0", "10.0, 4.0, 6.0")), "no error") << "they may touch";
  EXPECT_THAT(error(low_block + high_block + block("8.0, 1.75, 4.0", "10.0, 3.0, 6.0")),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("'water.block[2].min_m'"),
                    HasSubstr("block 3 of the water overlap block 1"),
                    HasSubstr("mend: move one of them by 0.25 m along y")));
  EXPECT_THAT(error(low_block + low_block), HasSubstr("block 2 of the water overlap block 1"));
  EXPECT_THAT(error(low_block + block("8.0, 4.0, 4.0", "20.0, 6.0, 6.0")),
              AllOf(HasSubstr("water.block[1].max_m"), HasSubstr("outside the tank")));
  EXPECT_THAT(error(block("8.0, 4.0, 4.0", "8.0, 6.0, 6.0")), HasSubstr("leaves no room for water"));
  EXPECT_THAT(error(low_block + high_block, true),
              AllOf(HasSubstr("'water.gate'"), HasSubstr("encloses one block"), HasSubstr("gate = false")));
  EXPECT_EQ(error(low_block, true), "no error") << "a gate round one";
  EXPECT_THAT(error("min_m = [0.0, 0.0, 0.0]\n" + high_block),
              AllOf(HasSubstr("'water.min_m'"), HasSubstr("together with [[water.block]]")));
  EXPECT_THAT(error(""), HasSubstr("'water.min_m' is missing"));
  std::string many;
  for (int k = 0; k < 17; ++k)
    many += block(std::to_string(k) + ".0, 0.0, 0.0", std::to_string(k + 1) + ".0, 1.0, 1.0");
  EXPECT_THAT(error(many), HasSubstr("use at most 16"));
}

TEST(WaterBlocks, HoldTheMassOfTheirVolumes) {
  for (const std::vector<WaterBlock>& water :
       {std::vector{pool, drop}, {drop, pool}, {drop, pool, {{0.1, 1.5, 0.1}, {0.3, 1.8, 0.9}}}}) {
    const auto scene = tank_with(water);
    for (const std::int64_t n_star : {256, 1000, 4096}) {
      for (const auto& traits : sim::all_methods()) {
        const auto points = sim::fill_positions(scene, traits.kind, n_star);
        ASSERT_EQ(static_cast<std::int64_t>(points.size()), sim::particle_count(traits.kind, n_star));
        const double d = sim::resolution_of(scene, traits.kind, n_star).spacing_m;
        std::size_t found = 0;
        for (const WaterBlock& one : water) {
          std::size_t count = 0;
          for (const auto& at : points) {
            // A block's last layer is only partly filled, and may lie above the block by less than a layer.
            const bool inside = at[0] > one.min_m[0] && at[0] < one.max_m[0] && at[1] > one.min_m[1] &&
                                at[1] < one.max_m[1] + d && at[2] > one.min_m[2] && at[2] < one.max_m[2];
            count += inside;
          }
          EXPECT_NEAR(static_cast<double>(count) * d * d * d, sim::volume_m3(one), d * d * d)
              << traits.name << " " << n_star;
          found += count;
        }
        EXPECT_EQ(found, points.size()) << "none elsewhere, none twice";
      }
    }
  }
}

TEST(WaterBlocks, OfLessThanAParticleAreRefused) {
  const auto scene = tank_with({pool, {{0.8, 0.9, 0.3}, {0.86, 0.96, 0.36}}});
  const auto check = [&](MethodKind method, std::int64_t n_star) {
    sim::check_extent(scene, method, n_star, 1);
  };
  EXPECT_NO_THROW(check(MethodKind::HiRes, 1024));  // d = 0.046 m
  EXPECT_THAT([&] { check(MethodKind::HiRes, 256); },
              testing::ThrowsMessage<base::Error>(AllOf(HasSubstr("water.block[1].max_m"),
                                                        HasSubstr("0.06 m thin"), HasSubstr("larger n_*"))));
  EXPECT_THAT(
      [&] { check(MethodKind::LoRes, 1024); },
      testing::ThrowsMessage<base::Error>(AllOf(HasSubstr("less than a particle"), HasSubstr("n_*"))));
  auto gated = tank_with({pool, drop});
  gated.gate = true;
  EXPECT_THAT([&] { sim::check_extent(gated, MethodKind::HiRes, 256, 1); },
              testing::ThrowsMessage<base::Error>(HasSubstr("water.gate")));
}

TEST(WaterBlocks, AllCountForKeysScalesAndTemperatures) {
  auto scene = tank_with({pool, drop});
  sim::SimulationOptions options;
  options.n_star = 256;
  const std::string key = sim::run_key(scene, options);
  scene.water[1].max_m[1] += 0.1;
  EXPECT_NE(sim::run_key(scene, options), key);
  EXPECT_EQ(sim::scales_of(tank_with({pool, drop}), 256).length_m,
            sim::scales_of(tank_with({drop}), 256).length_m);
  scene = tank_with({pool, drop});
  scene.effects = {{sim::EffectKind::Heat, 1e-3}};
  scene.warm = {{{0, 0, 0}, {2, 0.5, 1}, 320}};
  EXPECT_NEAR(sim::widest_difference_k(scene), 320 - 293.15, 1e-9) << "the drop has the reference";
  scene.warm[0].max_m[1] = 2;
  EXPECT_EQ(sim::widest_difference_k(scene), 0);
}

/// Runs a scene on the CPU, and expects it to keep its mass inside the tank.
std::vector<fluid_test::ParticleState> run(const sim::Scene& scene, MethodKind method, int frames) {
  sim::SimulationOptions options;
  options.method = method;
  options.n_star = 256;
  options.backend = sim::Backend::Cpu;
  const auto fluid = sim::make_simulation(scene, options);
  const auto mass = fluid->report().mass_units;
  EXPECT_EQ(mass, 8 * 256);
  for (int frame = 0; frame < frames; ++frame) fluid->step_frame();
  EXPECT_EQ(fluid->report().mass_units, mass);
  EXPECT_EQ(fluid->report().guards.not_finite, 0u);
  auto out = fluid->read_state();
  std::int64_t counted = 0;
  for (const auto& p : out) {
    counted += std::int64_t{1} << p.level;
    EXPECT_TRUE(p.x_m > -0.01f && p.x_m < 2.01f && p.z_m > -0.01f && p.z_m < 1.01f && p.y_m > -0.01f) << p.id;
  }
  EXPECT_EQ(counted, mass);
  return out;
}

double height_of_water(const std::vector<fluid_test::ParticleState>& state) {
  double sum = 0, mass = 0;
  for (const auto& p : state) {
    sum += static_cast<double>(p.y_m) * (1 << p.level);
    mass += 1 << p.level;
  }
  return sum / mass;
}

TEST(WaterBlocks, ADropFallsIntoAPoolAndNoneIsLost) {
  // At rest the water is (0.8 + 0.064) m3 / 2 m2 = 0.432 m deep.
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours}) {
    auto scene = tank_with({pool, drop});
    const auto before = run(scene, method, 0);
    EXPECT_NEAR(height_of_water(before), (0.8 * 0.2 + 0.064 * 1.1) / 0.864, 0.02);
    const auto after = run(scene, method, 240);
    EXPECT_NEAR(height_of_water(after), 0.216, 0.02) << sim::method_name(method);
    const auto top = std::max_element(after.begin(), after.end(),
                                      [](const auto& a, const auto& b) { return a.y_m < b.y_m; });
    EXPECT_LT(top->y_m, 0.7f) << "nothing hangs in the air";
  }
}

TEST(WaterBlocks, TwoColumnsMeetInTheMiddle) {
  const auto scene = tank_with({{{0, 0, 0}, {0.4, 0.8, 1}}, {{1.6, 0, 0}, {2, 0.8, 1}}});
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours}) {
    const auto middle = [](const std::vector<fluid_test::ParticleState>& state, double& balance) {
      double mass = 0, all = 0;
      balance = 0;
      for (const auto& p : state) {
        const double m = 1 << p.level, x = static_cast<double>(p.x_m);
        all += m;
        balance += m * (x - 1);
        if (std::abs(x - 1) < 0.2) mass += m;
      }
      balance /= all;
      return mass / all;
    };
    double balance = 0;
    EXPECT_EQ(middle(run(scene, method, 6), balance), 0) << sim::method_name(method);
    EXPECT_GT(middle(run(scene, method, 40), balance), 0.15) << sim::method_name(method);
    EXPECT_NEAR(balance, 0, 0.02) << "equal columns";
  }
}

}  // namespace
