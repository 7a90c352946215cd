/// Heat in whole runs: temperatures in scenes, conservation, and the account of heat that enters and leaves.

#include "libsim/scene/heat.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libsim/solver/state_file.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/levels_helpers.hpp"

namespace {

using sim::Backend;
using sim::EffectKind;
using sim::EffectOption;
using sim::MethodKind;
using testing::AllOf;
using testing::HasSubstr;

std::string faucet_with(const std::string& nozzle, const std::string& tables) {
  std::string text = base::read_file(base::resource("data/scenes/faucet.toml"), 1 << 20);
  const auto put = [&](const std::string& old, const std::string& now) {
    text.replace(text.find(old), old.size(), now);
  };
  put("format = 1", "format = 2");
  put("speed_m_s = 16.0\n", "speed_m_s = 16.0\n" + nozzle);
  return text + "\n" + tables;
}
const std::string heat_table = "[[effect]]\nkind = \"heat\"\ndiffusivity_m2_s = 0.01\n";
std::string warm_table(const std::string& temperature, const std::string& top = "1.0") {
  return "[[warm]]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [5.0, " + top +
         ", 5.0]\ntemperature_k = " + temperature + "\n";
}

TEST(Heat, TemperaturesAreReadFromASceneFile) {
  NEEDS_EFFECTS;
  const auto scene = sim::parse_scene(
      faucet_with("temperature_k = 353.15\n", heat_table + "reference_k = 280.0\n" + warm_table("275.0")),
      "scene.toml");
  EXPECT_EQ(scene.nozzles[0].temperature_k, 353.15);
  ASSERT_EQ(scene.warm.size(), 1u);
  EXPECT_EQ(scene.warm[0].max_m[0], 5);
  EXPECT_EQ(scene.warm[0].temperature_k, 275);
  EXPECT_EQ(sim::reference_temperature(scene), 280);
  const auto range = sim::temperatures_of(scene);
  EXPECT_EQ(range.least_k, 275);
  EXPECT_EQ(range.most_k, 353.15);
  EXPECT_EQ(sim::parse_scene(faucet_with("", heat_table), "scene.toml").nozzles[0].temperature_k, 0);
}

TEST(Heat, ErrorsNameThePlaceAndTheMend) {
  NEEDS_EFFECTS;
  const auto error = [](const std::string& nozzle, const std::string& tables) {
    return fluid_test::scene_error(faucet_with(nozzle, tables));
  };
  EXPECT_THAT(error("", warm_table("300.0")),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("needs the effect heat"), HasSubstr("list heat")));
  EXPECT_THAT(error("temperature_k = 300.0\n", ""), HasSubstr("needs the effect heat"));
  EXPECT_THAT(error("temperature_k = 0.0\n", heat_table), HasSubstr("out of range"));
  EXPECT_THAT(error("", heat_table + warm_table("300.0", "0.0")), HasSubstr("leaves the box empty"));
  EXPECT_THAT(error("", heat_table + warm_table("300.0") + "colour = 1\n"), HasSubstr("is not a known key"));
  EXPECT_THAT(error("", heat_table + "wall_k = -1.0\n"), HasSubstr("out of range"));
}

TEST(Heat, WaterThatWouldLoseHalfOfItsWeightIsRefused) {
  NEEDS_EFFECTS;
  const std::string strong = heat_table + "expansion_per_k = 0.002\nreference_k = 300.0\n";
  const auto error = [&](const std::string& nozzle, const std::string& tables) {
    return fluid_test::scene_error(faucet_with(nozzle, strong + tables));
  };
  const auto refused = AllOf(HasSubstr("scene.toml:"), HasSubstr("260 K apart times expansion_per_k = 0.002"),
                             HasSubstr("more than 0.5"), HasSubstr("lower expansion_per_k"));
  EXPECT_EQ(error("", warm_table("550.0")), "no error");
  EXPECT_THAT(error("", warm_table("560.0")), refused);
  EXPECT_THAT(error("temperature_k = 560.0\n", ""), refused);
  EXPECT_THAT(error("", "wall_k = 560.0\n"), refused);
  // The reference temperature counts only if some water has it: not if all water, from the start and from
  // nozzles, is at 560 K.
  const std::string all =
      "[[warm]]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [21.0, 3.0, 21.0]\ntemperature_k = 560.0\n";
  EXPECT_THAT(error("", all), refused);
  EXPECT_EQ(error("temperature_k = 560.0\n", all), "no error");
  EXPECT_EQ(error("temperature_k = 560.0\n", warm_table("300.0") + all), "no error") << "later boxes count";
  EXPECT_THAT(error("temperature_k = 560.0\n", all + warm_table("300.0")), refused);
}

TEST(Heat, StepsAreAsShortAsConductionNeeds) {
  EXPECT_NEAR(sim::longest_step({{EffectKind::Heat, 0.05}}, 0.1).seconds, 0.2 * 0.01 / 0.05, 1e-12);
}

/// A pool of the size of levels_test::Settled, with water of 310 K in the half x < middle.
sim::Scene warm_pool(double expansion = 0.002) {
  const double d = levels_test::d;
  auto scene = fluid_test::tank({12 * d, 30 * d, 12 * d}, {12 * d, 16 * d, 12 * d}, 20);
  sim::Effect heat{EffectKind::Heat, 0.02};
  heat.options[static_cast<std::size_t>(EffectOption::HeatExpansion)] = expansion;
  heat.options[static_cast<std::size_t>(EffectOption::HeatReference)] = 300;
  scene.effects = {heat};
  scene.warm = {{{-1, -1, -1}, {6 * d, 100, 100}, 310}};
  return scene;
}
std::vector<float> temperatures(const sim::Simulation& fluid) {
  std::vector<float> out;
  fluid.read_field(sim::ParticleField::Temperature, out);
  return out;
}

/// All particles merge, then a ball of water splits.
void the_total_stays(Backend backend) {
  NEEDS_EFFECTS;
  const auto options = levels_test::options_for(backend, 288, levels_test::everywhere(3));
  const auto fluid = sim::make_simulation(warm_pool(), options);
  const double before = fluid->report().heat.held;
  for (int frame = 0; frame < 40; ++frame) fluid->step_frame();
  const double d = levels_test::d;
  fluid->force_targets({{6 * d, 8 * d, 6 * d}, 4 * d, 0, 3});
  for (int frame = 0; frame < 40; ++frame) fluid->step_frame();
  const auto report = fluid->report();
  EXPECT_GT(report.levels.merges, 500u);
  EXPECT_GT(report.levels.splits, 10u);
  EXPECT_NEAR(report.heat.held / before, 1, 1e-5);
  // No water becomes colder or warmer than water was at the start.
  const auto theta = temperatures(*fluid);
  const auto [least, most] = std::minmax_element(theta.begin(), theta.end());
  EXPECT_GE(*least, -1e-4f);
  EXPECT_LE(*most, 10 + 1e-4f);
  EXPECT_GT(*most - *least, 0.5f);
}

/// A warm nozzle, an outlet and warm walls: the heat in the tank must equal that of the start plus what
/// entered less what left.
void the_ledger_closes(Backend backend, MethodKind method) {
  NEEDS_EFFECTS;
  auto scene = fluid_test::tank({4, 3, 4}, {4, 1, 4});
  scene.v_ref_m_s = 6;
  scene.nozzles = {{.diameter_m = 0.8,
                    .position_m = {2, 2, 2},
                    .speed_m_s = 3,
                    .on_frames = 20,
                    .off_frames = 5,
                    .temperature_k = 350}};
  scene.recirculation_corner_m = 1;
  scene.outlets = {{sim::Wall::LowX, {0, 1}, {0.5, 3}}};
  scene.warm = {{{-1, -1, -1}, {5, 5, 2}, 310}};
  sim::Effect heat{EffectKind::Heat, 0.02};
  heat.options[static_cast<std::size_t>(EffectOption::HeatWall)] = 330;
  scene.effects = {heat};
  sim::SimulationOptions options;
  options.backend = backend;
  options.method = method;
  options.n_star = 256;
  const auto fluid = sim::make_simulation(scene, options);
  const double before = fluid->report().heat.held;
  for (int frame = 0; frame < 40; ++frame) fluid->step_frame();
  const auto report = fluid->report();
  const auto& h = report.heat;
  EXPECT_NEAR(h.poured, static_cast<double>(report.poured) * (350 - 293.15), 1e-5 * h.poured);
  for (const double part : {h.poured, h.taken, h.drained, h.from_walls}) EXPECT_GT(part, 0.01 * before);
  EXPECT_NEAR((h.held + h.taken + h.drained - h.poured - h.from_walls) / before, 1, 1e-5);
}
void ledgers(Backend backend) {
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours}) the_ledger_closes(backend, method);
}

/// Water of 800 K is 507 K above the reference of 293.15 K, so that expansion times temperature difference is
/// above 1. It must rest as high as cold water.
void uniform_warmth_changes_nothing(Backend backend) {
  NEEDS_EFFECTS;
  for (const auto method : {MethodKind::HiRes, MethodKind::Ours}) {
    const auto height_after = [&](double kelvin) {
      auto scene = fluid_test::tank({1, 1.2, 0.6}, {1, 0.6, 0.6}, 60);
      scene.viscosity_m2_s = 0.001;
      sim::Effect heat{EffectKind::Heat, 0.001};
      heat.options[static_cast<std::size_t>(EffectOption::HeatExpansion)] = 0.0021;
      scene.effects = {heat};
      scene.warm = {{{-1, -1, -1}, {2, 2, 2}, kelvin}};
      sim::SimulationOptions options;
      options.backend = backend;
      options.method = method;
      options.n_star = 128;
      const auto fluid = sim::make_simulation(scene, options);
      for (int frame = 0; frame < 120; ++frame) fluid->step_frame();
      EXPECT_FALSE(fluid->divergence());
      return fluid_test::centre_height(fluid->read_state());
    };
    EXPECT_NEAR(height_after(800) / height_after(293.15), 1, 0.01) << sim::method_name(method);
  }
}

TEST(Heat, UniformWarmthChangesNothing) { uniform_warmth_changes_nothing(Backend::Cpu); }
TEST(HeatGpu, UniformWarmthChangesNothing) { uniform_warmth_changes_nothing(Backend::Cuda); }
TEST(Heat, TheTotalStaysThroughSplitsAndMerges) { the_total_stays(Backend::Cpu); }
TEST(Heat, TheLedgerClosesWithNozzleOutletAndWalls) { ledgers(Backend::Cpu); }
TEST(HeatGpu, TheTotalStaysThroughSplitsAndMerges) { the_total_stays(Backend::Cuda); }
TEST(HeatGpu, TheLedgerClosesWithNozzleOutletAndWalls) { ledgers(Backend::Cuda); }

TEST(Heat, GoesOnFromASavedState) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  const auto scene = warm_pool();
  auto options = levels_test::options_for(Backend::Cpu, 288, levels_test::everywhere(3));
  const auto fluid = sim::make_simulation(scene, options);
  for (int frame = 0; frame < 12; ++frame) fluid->step_frame();
  fluid->save_state(folder.path() / "state");
  options.resume_from = folder.path() / "state";
  const auto again = sim::make_simulation(scene, options);
  EXPECT_EQ(temperatures(*again), temperatures(*fluid));
  for (int frame = 0; frame < 6; ++frame) {
    fluid->step_frame();
    again->step_frame();
  }
  EXPECT_EQ(temperatures(*again), temperatures(*fluid));
  EXPECT_EQ(again->report().heat.held, fluid->report().heat.held);
}

TEST(Heat, BelongsToTheKeyOfAState) {
  auto scene = warm_pool();
  scene.nozzles.emplace_back();
  const sim::SimulationOptions options;
  const std::string key = sim::run_key(scene, options);
  scene.warm[0].temperature_k = 311;
  EXPECT_NE(sim::run_key(scene, options), key);
  scene.warm[0].temperature_k = 310;
  scene.nozzles[0].temperature_k = 311;
  EXPECT_NE(sim::run_key(scene, options), key);
}

}  // namespace
