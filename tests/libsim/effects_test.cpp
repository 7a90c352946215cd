/// Effects that a scene lists: their tables, their cost when absent, their substeps, their documentation.

#include "libsim/scene/effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <sstream>

#include "libsim/solver/state_file.hpp"
#include "stats/base/error.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using fluid_test::ParticleState;
using sim::EffectKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string dam_of_format(const std::string& format) {
  std::string text = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
  const std::string old = "format = 1";
  return text.replace(text.find(old), old.size(), "format = " + format);
}
std::string dam_with(const std::string& effects) { return dam_of_format("2") + "\n" + effects; }
std::string effect(const std::string& kind, const std::string& key, const std::string& value) {
  return "[[effect]]\nkind = \"" + kind + "\"\n" + key + " = " + value + "\n";
}
const std::string tension = effect("cohesion", "tension_n_m", "50.0");

TEST(Effects, FormatsOneAndTwoAreRead) {
  EXPECT_TRUE(sim::parse_scene(dam_of_format("1"), "scene.toml").effects.empty());
  EXPECT_TRUE(sim::parse_scene(dam_of_format("2"), "scene.toml").effects.empty());
  EXPECT_THAT(fluid_test::scene_error(dam_of_format("3")),
              AllOf(HasSubstr("scene.toml:3:"), HasSubstr("is not a format that this program reads")));
}

TEST(Effects, AreReadFromASceneFile) {
  NEEDS_EFFECTS;
  const auto scene =
      sim::parse_scene(dam_with(tension + effect("air_drag", "rate_per_s", "0.0")), "scene.toml");
  ASSERT_EQ(scene.effects.size(), 2u);
  EXPECT_EQ(scene.effects[0].kind, EffectKind::Cohesion);
  EXPECT_EQ(scene.effects[0].coefficient, 50);
  EXPECT_EQ(scene.effects[1].kind, EffectKind::AirDrag);
  EXPECT_EQ(scene.effects[1].coefficient, 0);
}

TEST(Effects, OptionsHaveUsualValuesAndRangesAndStandInTheStatesKey) {
  NEEDS_EFFECTS;
  const std::string drag = effect("air_drag", "rate_per_s", "0.5");
  const auto option = static_cast<std::size_t>(sim::EffectOption::AirDragCoarsest);
  EXPECT_EQ(sim::parse_scene(dam_with(drag), "scene.toml").effects[0].options[option], 3);
  auto scene = sim::parse_scene(dam_with(drag + "coarsest_level = 1.0\n"), "scene.toml");
  EXPECT_EQ(scene.effects[0].options[option], 1);
  EXPECT_EQ(sim::options_in_words(scene.effects[0]), " coarsest_level = 1");
  EXPECT_EQ(sim::coefficients_of(scene.effects)[sim::EffectOption::AirDragCoarsest], 1);
  EXPECT_THAT(fluid_test::scene_error(dam_with(drag + "coarsest_level = 4.0\n")),
              AllOf(HasSubstr("coarsest_level"), HasSubstr("out of range")));
  EXPECT_THAT(fluid_test::scene_error(
                  dam_with(tension + effect("adhesion", "work_n_m", "5.0") + "coarsest_level = 1.0\n")),
              HasSubstr("is not a known key"));
  scene.effects[0].options[option] = -1;
  EXPECT_THROW(sim::check_effects(scene.effects), base::Error);
}

TEST(Effects, ErrorsNameThePlaceAndTheMend) {
  NEEDS_EFFECTS;
  const auto error = [](const std::string& effects) { return fluid_test::scene_error(dam_with(effects)); };
  EXPECT_THAT(fluid_test::scene_error(dam_of_format("1") + "\n" + tension),
              AllOf(HasSubstr("scene.toml:3:"), HasSubstr("came with format 2"), HasSubstr("format = 2")));
  EXPECT_THAT(error(effect("magic", "x", "1.0")), AllOf(HasSubstr("effect"), HasSubstr("cohesion")));
  EXPECT_THAT(error(effect("cohesion", "tension_n_m", "-1.0")),
              AllOf(HasSubstr("tension_n_m"), HasSubstr("out of range")));
  EXPECT_THAT(error(effect("cohesion", "tension", "1.0")), HasSubstr("tension_n_m' is missing"));
  EXPECT_THAT(error(tension + "colour = 1\n"), HasSubstr("is not a known key"));
  const std::string twice = error(tension + tension);
  EXPECT_THAT(twice, AllOf(HasSubstr("kind"), HasSubstr("is listed twice"), HasSubstr("keep one")));
  // The error points at the second table's `kind`.
  const std::string text = dam_with(tension);
  const auto line = 2 + std::count(text.begin(), text.end(), '\n');
  EXPECT_THAT(twice, HasSubstr("scene.toml:" + std::to_string(line) + ":"));
  EXPECT_THAT(error(effect("adhesion", "work_n_m", "5.0")),
              AllOf(HasSubstr("needs cohesion"), HasSubstr("list cohesion too")));
  EXPECT_THAT(error(effect("cohesion", "tension_n_m", "0.0") + effect("adhesion", "work_n_m", "5.0")),
              HasSubstr("needs cohesion"));
  EXPECT_EQ(error(effect("adhesion", "work_n_m", "0.0")), "no error");
}

TEST(Effects, AProgramWithoutEffectsRefusesThem) {
  if (sim::has_effects()) GTEST_SKIP() << "built with -DVIP_EFFECTS=ON";
  EXPECT_THAT(fluid_test::scene_error(dam_with(tension)),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("built without"), HasSubstr("-DVIP_EFFECTS=ON")));
  EXPECT_THROW(sim::check_effects({{EffectKind::Cohesion, 1}}), base::Error);
}

sim::Scene small_dam() {
  auto scene = fluid_test::tank({2.4, 2, 1.2}, {1.2, 1.2, 1.2});
  scene.v_ref_m_s = 5;
  scene.viscosity_m2_s = 0.005;
  return scene;
}

sim::SimulationOptions options_of(sim::MethodKind method = sim::MethodKind::HiRes) {
  sim::SimulationOptions out;
  out.method = method;
  out.n_star = 64;
  return out;
}

struct Cost {
  std::string explanation;
  std::map<std::string, int> launches;
  std::size_t bytes = 0;
  std::vector<ParticleState> state;
};
Cost cost_of(const sim::Scene& scene, sim::MethodKind method) {
  const auto fluid = sim::make_simulation(scene, options_of(method));
  Cost out;
  fluid->profile_launches(true);
  for (int frame = 0; frame < 4; ++frame) fluid->step_frame();
  for (const auto& pass : fluid->launch_times()) out.launches[pass.label] = pass.launches;
  fluid->profile_launches(false);
  out.explanation = fluid->explain();
  out.bytes = fluid->particle_bytes();
  out.state = fluid->read_state();
  return out;
}
bool same_bits(const std::vector<ParticleState>& a, const std::vector<ParticleState>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST(Effects, OfCoefficientZeroCostNothingAndChangeNoBit) {
  NEEDS_EFFECTS;
  for (const auto& method : sim::all_methods()) {
    auto scene = small_dam();
    const Cost bare = cost_of(scene, method.kind);
    scene.effects.clear();
    for (std::size_t k = 0; k < sim::effect_count; ++k)
      scene.effects.push_back({static_cast<EffectKind>(k), 0});
    const Cost zero = cost_of(scene, method.kind);
    EXPECT_EQ(zero.launches, bare.launches) << method.name;
    EXPECT_EQ(zero.bytes, bare.bytes) << method.name;
    EXPECT_TRUE(same_bits(zero.state, bare.state)) << method.name;
    EXPECT_THAT(bare.explanation, Not(HasSubstr("dropped")));
    EXPECT_THAT(zero.explanation, HasSubstr("dropped: the scene lists tension_n_m = 0"));
    // The same measurement detects an effect that is present.
    scene.effects = {{EffectKind::Cohesion, 20}};
    const Cost with = cost_of(scene, method.kind);
    EXPECT_EQ(bare.launches.count("cohesion"), 0u);
    EXPECT_GT(with.launches.at("cohesion"), 0) << method.name;
    // With levels the average Drift uses the column of the surface normals in any case.
    if (!method.adaptive()) {
      EXPECT_GT(with.bytes, bare.bytes) << method.name;
    }
    EXPECT_FALSE(same_bits(with.state, bare.state)) << method.name;
    EXPECT_THAT(with.explanation, HasSubstr("the scene lists tension_n_m = 20"));
  }
}

TEST(Effects, TheirExplicitLimitRaisesTheSubstepsAndSaysSo) {
  NEEDS_EFFECTS;
  auto scene = small_dam();
  const int usual = sim::substeps_of(scene, 64);
  scene.effects = {{EffectKind::Cohesion, 10'000}};
  const double d = sim::resolution_of(scene, sim::MethodKind::HiRes, 64).finest_spacing_m;
  const auto longest = sim::longest_step(scene.effects, d);
  EXPECT_NEAR(longest.seconds, 0.2 * std::sqrt(1000 * d * d * d / 10'000), 1e-12);
  const auto fluid = sim::make_simulation(scene, options_of());
  EXPECT_THAT(fluid->explain(), HasSubstr("substeps of at most"));
  fluid->step_frame();
  const int taken = fluid->substeps().taken;
  EXPECT_GT(taken, usual);
  EXPECT_LE(scene.frame_dt_s / taken, longest.seconds * (1 + 1e-9));

  auto options = options_of();
  options.substeps = static_cast<int>(std::ceil(scene.frame_dt_s / longest.seconds)) - 1;
  EXPECT_THAT([&] { sim::make_simulation(scene, options); },
              testing::ThrowsMessage<base::Error>(
                  AllOf(HasSubstr("effect cohesion"), HasSubstr("were asked for"),
                        HasSubstr("set substeps to " + std::to_string(options.substeps + 1) + " or more"))));
  ++options.substeps;
  EXPECT_NO_THROW(sim::make_simulation(scene, options));
  const double least_rate = sim::longest_step({{EffectKind::AirDrag, 1}}, d).seconds / scene.frame_dt_s;
  scene.effects = {
      {EffectKind::AirDrag, 99.5 * least_rate}};  // needs 100 substeps; the option has 64 at most
  EXPECT_THAT([&] { sim::make_simulation(scene, options); },
              testing::ThrowsMessage<base::Error>(HasSubstr("set substeps to 0 (the run then chooses)")));
  scene.effects = {{EffectKind::AirDrag, 1e6}};
  for (const int fixed : {0, options.substeps}) {
    options.substeps = fixed;
    EXPECT_THAT([&] { sim::make_simulation(scene, options); },
                testing::ThrowsMessage<base::Error>(AllOf(
                    HasSubstr("effect air_drag"), HasSubstr("lower rate_per_s"), Not(HasSubstr("set ")))));
  }
}

TEST(Effects, ViscosityAsksForNoShorterSubstepsAndAddsToTheWaters) {
  NEEDS_EFFECTS;
  auto scene = small_dam();
  scene.effects = {{EffectKind::Viscosity, 1000}};
  EXPECT_EQ(sim::longest_step(scene.effects, 0.01).of, sim::no_effect);
  EXPECT_NEAR(sim::scales_of(scene, 64).viscosity_m2_s, 1000.005, 1e-6);
  for (const auto& method : sim::all_methods()) {
    const auto fluid = sim::make_simulation(scene, options_of(method.kind));
    EXPECT_THAT(fluid->explain(), AllOf(HasSubstr("ask for no shorter substeps"), HasSubstr("1000 m2/s")));
    for (int frame = 0; frame < 8; ++frame) fluid->step_frame();
    EXPECT_EQ(fluid->substeps().taken, sim::substeps_of(scene, 64)) << method.name;
    for (const auto& p : fluid->read_state())
      ASSERT_LT(std::hypot(p.vx_m_s, p.vy_m_s, p.vz_m_s), 1.5f) << method.name;
  }
}

TEST(Effects, FrictionAsksForNoShorterSubstepsAndVorticityForAFifthOfTheWayThroughASpacing) {
  NEEDS_EFFECTS;
  EXPECT_EQ(sim::longest_step({{EffectKind::Friction, 1e6}}, 0.01).of, sim::no_effect);
  const auto longest = sim::longest_step({{EffectKind::Friction, 1}, {EffectKind::Vorticity, 4}}, 0.1);
  EXPECT_EQ(longest.of, EffectKind::Vorticity);
  EXPECT_NEAR(longest.seconds, 0.2 * 0.1 / 4, 1e-12);
}

TEST(Effects, AreCheckedInScenesThatNoFileDescribes) {
  NEEDS_EFFECTS;
  const auto fails = [](std::vector<sim::Effect> effects, const std::string& with) {
    auto scene = small_dam();
    scene.effects = std::move(effects);
    EXPECT_THAT([&] { sim::make_simulation(scene, options_of()); },
                testing::ThrowsMessage<base::Error>(HasSubstr(with)));
  };
  fails({{EffectKind::Cohesion, -1}}, "out of range");
  fails({{EffectKind::Cohesion, std::nan("")}}, "out of range");
  fails({{EffectKind::Cohesion, 1}, {EffectKind::Cohesion, 2}}, "listed twice");
  fails({{EffectKind::Adhesion, 1}}, "needs cohesion");
}

TEST(Effects, AreEntriesOfTheAccountOfMomentum) {
  NEEDS_EFFECTS;
  auto scene = small_dam();
  scene.effects = {{EffectKind::Viscosity, 0.05}, {EffectKind::Cohesion, 20},   {EffectKind::Adhesion, 10},
                   {EffectKind::AirDrag, 2},      {EffectKind::Vorticity, 0.2}, {EffectKind::Friction, 0.5}};
  auto options = options_of(sim::MethodKind::Ours);
  options.wall_impulse = true;
  const auto fluid = sim::make_simulation(scene, options);
  double gave = 0;
  for (int frame = 0; frame < 20; ++frame) {
    fluid->step_frame();
    const auto a = fluid->momentum();
    const auto walls = a.walls_sum();
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(a.after[k],
                  a.before[k] + a.forces[k] + walls[k] + a.flow[k] + a.levels[k] + a.braked[k] +
                      a.viscosity[k] + a.effects[k] + a.inherited[k] + a.unattributed[k],
                  1e-3);
      gave += std::abs(a.effects[k]);
    }
  }
  EXPECT_GT(gave, 1);
}

/// Each ```cpp block of the page must be in the source file that the page named last before it.
TEST(Effects, ThePageQuotesTheSources) {
  std::istringstream page(base::read_file(base::resource("docs/architecture.md"), 1 << 20));
  const std::string root = std::string(VIP_TEST_DIR) + "/../";
  std::string file, block;
  bool inside = false;
  int blocks = 0;
  for (std::string line; std::getline(page, line);) {
    if (line == "```cpp") {
      inside = true;
      block.clear();
    } else if (inside && line == "```") {
      inside = false;
      ++blocks;
      EXPECT_NE(base::read_file(root + file, 1 << 20).find(block), std::string::npos) << file << "\n"
                                                                                      << block;
    } else if (inside) {
      block += line + "\n";
    } else if (const auto at = line.find("`libsim/"), test = line.find("`tests/");
               std::min(at, test) != std::string::npos) {
      const auto begin = std::min(at, test) + 1;
      const std::string named = line.substr(begin, line.find('`', begin) - begin);
      if (named.ends_with("pp")) file = named;
    }
  }
  EXPECT_EQ(blocks, 3);
}

TEST(Effects, ExplainStatesTheLimitsOfThickFluid) {
  NEEDS_EFFECTS;
  auto scene = small_dam();
  const auto says = [&] { return sim::make_simulation(scene, options_of())->explain(); };
  const std::string words = "resist shear slower than ";
  EXPECT_THAT(says(), Not(HasSubstr(words)));
  scene.effects = {{EffectKind::Viscosity, 0.5}};
  std::ostringstream shear;  // 0.1 g h / nu at half the height below the surface
  shear << 0.1 * scene.gravity_m_s2.size() * (scene.water.front().max_m[1] - scene.water.front().min_m[1]) /
               2 / 0.5;
  EXPECT_THAT(says(), HasSubstr(words + shear.str() + " /s by more than a quarter"));
  scene.gravity_m_s2 = 0;
  EXPECT_THAT(says(), Not(HasSubstr(words)));
  scene.gravity_m_s2 = 9.81;
  scene.effects = {{EffectKind::Viscosity, 0}};
  EXPECT_THAT(says(), Not(HasSubstr(words)));
}

/// Numbers that comments of the demo scenes give must be those that scales_of() computes.
TEST(Effects, DemoScenesHaveTheNumbersOfTheirComments) {
  NEEDS_EFFECTS;
  const auto scales = [](const char* name) {
    return sim::scales_of(sim::read_scene(std::string("data/scenes/") + name + ".toml"), 4096);
  };
  const auto droplet = scales("droplet");
  EXPECT_NEAR(droplet.reynolds, 400, 0.5);
  EXPECT_NEAR(droplet.weber, 2, 0.005);
  EXPECT_EQ(droplet.bond, 0);
  const auto puddle = scales("puddle");
  EXPECT_NEAR(puddle.reynolds, 160, 0.5);
  EXPECT_NEAR(puddle.weber, 2.67, 0.005);
  EXPECT_NEAR(puddle.bond, 2.09, 0.005);
  const auto honey = scales("honey");
  EXPECT_NEAR(honey.reynolds, 6.4, 0.005);
  EXPECT_EQ(honey.viscosity_m2_s, 0.5);
  const auto splash = scales("splash");
  EXPECT_NEAR(splash.reynolds, 900, 0.5);
  EXPECT_TRUE(std::isinf(splash.weber));
  EXPECT_NEAR(scales("wake").reynolds, 2500, 0.5);
  EXPECT_NEAR(scales("rough_floor").reynolds, 1200, 0.5);
  EXPECT_NEAR(scales("hot_jet").reynolds, 240, 0.5);
  const auto spray = scales("sea_spray");
  EXPECT_NEAR(spray.reynolds, 2000, 0.5);
  EXPECT_TRUE(std::isinf(spray.weber));
  EXPECT_NEAR(scales("pool_light").reynolds, 1350, 0.5);
  EXPECT_NEAR(scales("boat").reynolds, 1700, 0.5);
  EXPECT_NEAR(scales("crates").reynolds, 800, 0.5);
}

TEST(PictureEffects, AreReadFromASceneFileBesideTheOthers) {
  const auto scene = sim::parse_scene(
      dam_with("[[effect]]\nkind = \"shadows\"\n" + effect("caustics", "strength", "0.5")), "scene.toml");
  EXPECT_TRUE(scene.effects.empty());
  ASSERT_EQ(scene.picture_effects.size(), 2u);
  EXPECT_EQ(sim::strength_of(scene.picture_effects, sim::PictureEffectKind::Shadows), 1);
  EXPECT_EQ(sim::strength_of(scene.picture_effects, sim::PictureEffectKind::Caustics), 0.5F);
  EXPECT_EQ(sim::strength_of({}, sim::PictureEffectKind::Caustics), 0);
}

TEST(PictureEffects, ErrorsNameThePlaceAndTheMend) {
  const auto error = [](const std::string& effects) { return fluid_test::scene_error(dam_with(effects)); };
  const std::string shadows = effect("shadows", "strength", "1.0");
  EXPECT_THAT(error(effect("magic", "x", "1.0")), AllOf(HasSubstr("\"shadows\""), HasSubstr("\"caustics\"")));
  EXPECT_THAT(error(shadows + shadows),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("is listed twice"), HasSubstr("keep one")));
  EXPECT_THAT(error(effect("shadows", "strength", "1.5")),
              AllOf(HasSubstr("strength"), HasSubstr("out of range")));
  EXPECT_THAT(error(effect("shadows", "tension_n_m", "1.0")), HasSubstr("is not a known key"));
  EXPECT_THAT(fluid_test::scene_error(dam_of_format("1") + "\n" + shadows), HasSubstr("came with format 2"));
}

TEST(PictureEffects, EachHasOnePassAndStandsInTheDocs) {
  const std::string page = base::read_file(base::resource("docs/methods.md"), 1 << 20);
  for (const std::string& word : sim::picture_effect_words()) {
    EXPECT_TRUE(std::filesystem::exists(base::resource("shaders/" + word + ".comp"))) << word;
    EXPECT_THAT(page, HasSubstr("| `" + word + "` |"));
  }
}

TEST(PictureEffects, AreNothingToTheSolver) {
  auto scene = small_dam();
  const Cost bare = cost_of(scene, sim::MethodKind::OursTsp);
  const std::string key = sim::run_key(scene, options_of());
  scene.picture_effects = {{sim::PictureEffectKind::Shadows}, {sim::PictureEffectKind::Caustics}};
  const Cost with = cost_of(scene, sim::MethodKind::OursTsp);
  EXPECT_EQ(with.launches, bare.launches);
  EXPECT_EQ(with.bytes, bare.bytes);
  EXPECT_EQ(with.explanation, bare.explanation);
  EXPECT_TRUE(same_bits(with.state, bare.state));
  EXPECT_EQ(sim::run_key(scene, options_of()), key);
}

TEST(Effects, BelongToTheKeyOfAState) {
  auto scene = small_dam();
  const std::string bare = sim::run_key(scene, options_of());
  scene.effects = {{EffectKind::Cohesion, 20}};
  const std::string with = sim::run_key(scene, options_of());
  scene.effects[0].coefficient = 21;
  EXPECT_NE(with, bare);
  EXPECT_NE(sim::run_key(scene, options_of()), with);
}

}  // namespace
