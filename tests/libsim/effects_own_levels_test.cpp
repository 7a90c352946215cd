/// Effects that leave out coarse water, in scenes and whole runs, and stages that have nothing to do.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/toml.hpp"
#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::EffectKind;
using sim::MethodKind;
using testing::HasSubstr;
using testing::Not;

std::vector<EffectKind> all_kinds() {
  std::vector<EffectKind> out;
  for (std::size_t k = 0; k < sim::effect_count; ++k) out.push_back(static_cast<EffectKind>(k));
  return out;
}

TEST(OwnLevels, EveryEffectHasACoarsestLevelAndAdhesionThatOfCohesion) {
  NEEDS_EFFECTS;
  for (const EffectKind kind : all_kinds()) {
    const auto option = sim::coarsest_level_of(kind);
    ASSERT_TRUE(option) << sim::traits_of(kind).word;
    EXPECT_EQ(sim::traits_of(*option).usual, sim::most_levels - 1) << sim::traits_of(kind).word;
    if (kind == EffectKind::Adhesion) {
      EXPECT_EQ(sim::traits_of(*option).of, EffectKind::Cohesion);
      continue;
    }
    EXPECT_EQ(sim::traits_of(*option).of, kind);
    const std::string table = std::string("[[effect]]\nkind = \"") + sim::traits_of(kind).word + "\"\n" +
                              sim::traits_of(kind).key + " = 1\ncoarsest_level = ";
    const auto read = [&](const char* value) {
      return sim::read_effects(base::parse_toml(table + value + "\n", "e.toml").tables("effect"));
    };
    EXPECT_EQ(read("2")[0].options[static_cast<std::size_t>(*option)], 2);
    for (const char* wrong : {"4", "-1"})
      EXPECT_THAT([&] { read(wrong); }, testing::ThrowsMessage<base::Error>(testing::AllOf(
                                            HasSubstr("e.toml:4:"), HasSubstr("out of range"))));
    EXPECT_THAT([&] { read("0.5"); }, testing::ThrowsMessage<base::Error>(HasSubstr("is no whole number")));
    sim::Effect effect{kind, 1};
    effect.options[static_cast<std::size_t>(*option)] = 4;
    EXPECT_THROW(sim::check_effects({effect}), base::Error);
  }
}

/// All effects that have a coarsest level, up to this level, with coefficients that need no additional
/// substeps.
std::vector<sim::Effect> effects_to(double coarsest) {
  std::vector<sim::Effect> out{{EffectKind::Viscosity, 0.05}, {EffectKind::Cohesion, 20},
                               {EffectKind::Adhesion, 10},    {EffectKind::AirDrag, 2},
                               {EffectKind::Vorticity, 1},    {EffectKind::Friction, 0.5},
                               {EffectKind::Heat, 0.02}};
  for (auto& effect : out)
    effect.options[static_cast<std::size_t>(*sim::coarsest_level_of(effect.kind))] = coarsest;
  return out;
}

sim::Scene small_dam(std::vector<sim::Effect> effects = {}) {
  auto scene = fluid_test::tank({2.4, 2, 1.2}, {1.2, 1.2, 1.2});
  scene.v_ref_m_s = 5;
  scene.effects = std::move(effects);
  if (!scene.effects.empty()) scene.warm = {{{0, 0, 0}, {0.6, 0.6, 0.6}, 350}};
  return scene;
}
std::unique_ptr<sim::Simulation> fluid_of(const sim::Scene& scene, MethodKind method,
                                          const sim::SimulationOptions& numbers = {}) {
  auto options = numbers;
  options.method = method;
  options.n_star = 64;
  return sim::make_simulation(scene, options);
}

struct Outcome {
  std::string explanation;
  std::vector<fluid_test::ParticleState> state;
};
Outcome run(MethodKind method, std::vector<sim::Effect> effects) {
  const auto fluid = fluid_of(small_dam(std::move(effects)), method);
  Outcome out{.explanation = fluid->explain(), .state = {}};
  for (int frame = 0; frame < 6; ++frame) fluid->step_frame();
  out.state = fluid->read_state();
  return out;
}
std::string bits(const std::vector<fluid_test::ParticleState>& state) {
  return {reinterpret_cast<const char*>(state.data()), state.size() * sizeof state[0]};
}
bool same_bits(const Outcome& a, const Outcome& b) { return bits(a.state) == bits(b.state); }

TEST(OwnLevels, WaterOfCoarserLevelsAloneIsThatWithoutEffectsAndExplainSaysSo) {
  NEEDS_EFFECTS;
  const Outcome bare = run(MethodKind::LoRes, {});
  const Outcome idle = run(MethodKind::LoRes, effects_to(2));
  EXPECT_TRUE(same_bits(bare, idle));
  EXPECT_FALSE(same_bits(bare, run(MethodKind::LoRes, effects_to(3))))
      << "they must act for the test to mean anything";
  for (const auto& effect : effects_to(2))
    EXPECT_THAT(idle.explanation, HasSubstr(std::string("idle: ") + sim::traits_of(effect.kind).word +
                                            " is for level 0 to 2, and no water is so fine\n"));
  EXPECT_THAT(run(MethodKind::LoRes, effects_to(0)).explanation,
              HasSubstr(" is for level 0, and no water is so fine\n"));
}

TEST(OwnLevels, ExplainSaysNothingOfEffectsThatAct) {
  NEEDS_EFFECTS;
  const std::string words = "idle: ";
  EXPECT_THAT(run(MethodKind::LoRes, effects_to(3)).explanation, Not(HasSubstr(words)));
  for (const MethodKind method : {MethodKind::HiRes, MethodKind::Ours})
    EXPECT_THAT(run(method, effects_to(0)).explanation, Not(HasSubstr(words)));
  EXPECT_THAT(run(MethodKind::LoRes, {{EffectKind::Cohesion, 0}}).explanation, Not(HasSubstr(words)));
}

TEST(OwnLevels, FineWaterIsThatOfEffectsAtAllLevels) {
  NEEDS_EFFECTS;
  EXPECT_TRUE(same_bits(run(MethodKind::HiRes, effects_to(0)), run(MethodKind::HiRes, effects_to(3))));
  EXPECT_FALSE(same_bits(run(MethodKind::Ours, effects_to(0)), run(MethodKind::Ours, effects_to(3))));
}

/// Cost of a run: launches in two frames, substeps and memory.
struct Price {
  std::int64_t launches = 0;
  int substeps = 0;
  std::size_t bytes = 0;
  bool operator==(const Price&) const = default;
};
std::int64_t launches_of(sim::Simulation& fluid, int frames) {
  std::int64_t out = 0;
  fluid.profile_launches(true);
  for (int frame = 0; frame < frames; ++frame) fluid.step_frame();
  for (const auto& time : fluid.launch_times()) out += time.launches;
  fluid.profile_launches(false);
  return out;
}
Price price_of(sim::Simulation& fluid) {
  Price out{.launches = launches_of(fluid, 2)};
  out.substeps = fluid.substeps().taken;
  out.bytes = fluid.particle_bytes();
  return out;
}

/// A coefficient so large that the effect needs more substeps than the scene, if the effect's unit limits the
/// substep at all.
double brisk(EffectKind kind) {
  switch (sim::traits_of(kind).unit) {
    case sim::EffectUnit::NewtonPerMetre:
      return 1e4;
    case sim::EffectUnit::PerSecond:
      return 100;
    case sim::EffectUnit::MetrePerSecond:
      return 10;
    case sim::EffectUnit::MetreSquaredPerSecond:
    case sim::EffectUnit::Unlimited:
      break;
  }
  return 1;
}

/// The effect for levels up to this one, and the effect that it requires.
std::vector<sim::Effect> alone(EffectKind kind, int coarsest) {
  std::vector<sim::Effect> out{{kind, brisk(kind)}};
  if (const EffectKind needs = sim::traits_of(kind).needs; needs != sim::no_effect)
    out.push_back({needs, brisk(needs)});
  for (auto& effect : out) effect.options[static_cast<std::size_t>(*sim::coarsest_level_of(kind))] = coarsest;
  return out;
}

TEST(OwnLevels, EveryEffectCostsNothingWhereItIsIdleAndLaunchesWhereItActs) {
  NEEDS_EFFECTS;
  sim::SimulationOptions options, never_rests;
  options.temporal.fixed_tau = -20;
  never_rests.temporal.fixed_tau = 0;
  for (const auto& method : sim::all_methods()) {
    const Price bare = price_of(*fluid_of(small_dam(), method.kind, options));
    const Price solved = price_of(*fluid_of(small_dam(), method.kind, never_rests));
    for (const EffectKind kind : all_kinds()) {
      for (int coarsest = 0; coarsest < sim::most_levels; ++coarsest) {
        SCOPED_TRACE(std::string(method.name) + ", " + sim::traits_of(kind).word + " up to level " +
                     std::to_string(coarsest));
        const auto fluid = fluid_of(small_dam(alone(kind, coarsest)), method.kind, options);
        const Price price = price_of(*fluid);
        const bool idle = method.kind == MethodKind::LoRes && coarsest < 3;
        EXPECT_EQ(fluid->explain().find("idle: ") != std::string::npos, idle);
        if (idle) {
          EXPECT_EQ(price, bare);
          EXPECT_EQ(fluid->foam_capacity(), 0);
        } else {
          // Only foam lets particles rest.
          const Price& without = kind == EffectKind::Foam ? bare : solved;
          EXPECT_GT(price.launches, without.launches);
          EXPECT_EQ(price.substeps > without.substeps,
                    sim::traits_of(kind).unit != sim::EffectUnit::Unlimited);
        }
      }
    }
  }
}

TEST(OwnLevels, NoParticleRestsWhereAnEffectOtherThanFoamActs) {
  NEEDS_EFFECTS;
  sim::SimulationOptions options, never_rests;
  options.temporal.fixed_tau = -60;
  never_rests.temporal.fixed_tau = 0;
  const auto rests = [](sim::Simulation& fluid) {
    bool out = false;
    for (int frame = 0; frame < 6; ++frame) {
      fluid.step_frame();
      out = out || fluid.account().temporal->active < fluid.particle_count();
    }
    return out;
  };
  const auto dam = [](const std::vector<sim::Effect>& effects) {
    auto out = small_dam(effects);
    out.min_substeps = 2;
    return out;
  };
  EXPECT_TRUE(rests(*fluid_of(dam({}), MethodKind::OursTsp, options)));
  for (const EffectKind kind : all_kinds()) {
    SCOPED_TRACE(sim::traits_of(kind).word);
    const auto scene = dam(alone(kind, 3));
    const auto fluid = fluid_of(scene, MethodKind::OursTsp, options);
    const bool foam = kind == EffectKind::Foam;
    const auto reason =
        std::string("no particle rests where the effect ") + sim::traits_of(kind).word + " acts";
    EXPECT_EQ(fluid->explain().find(reason) == std::string::npos, foam);
    EXPECT_EQ(rests(*fluid), foam);
    if (foam) continue;
    const auto solved = fluid_of(scene, MethodKind::OursTsp, never_rests);
    EXPECT_FALSE(rests(*solved));
    EXPECT_EQ(launches_of(*fluid, 6), launches_of(*solved, 6));
    fluid->set_effects({});
    EXPECT_TRUE(rests(*fluid));
  }
}

TEST(OwnLevels, AStartAndNozzlesSayWhichLevelsMayBePresent) {
  NEEDS_EFFECTS;
  const auto price = [](const sim::Scene& scene, std::vector<int> levels) {
    sim::SimulationOptions options;
    std::vector<sim::ParticleState> start(levels.size());
    for (std::size_t i = 0; i < levels.size(); ++i) {
      start[i].id = static_cast<int>(i);
      start[i].level = levels[i];
      start[i].x_m = start[i].y_m = start[i].z_m = 0.3f + 0.3f * static_cast<float>(i);
    }
    options.start = start;
    return fluid_of(scene, MethodKind::HiRes, options);
  };
  const auto drag = alone(EffectKind::AirDrag, 1);
  const auto acts = [&](const sim::Scene& scene, std::vector<int> levels) {
    return price(scene, std::move(levels))->explain().find("idle: ") == std::string::npos;
  };
  auto scene = small_dam(drag);
  EXPECT_TRUE(acts(scene, {1, 3}));
  EXPECT_FALSE(acts(scene, {2, 3}));
  EXPECT_FALSE(acts(scene, {3, 3}));
  scene.nozzles.push_back({});
  EXPECT_TRUE(acts(scene, {2, 3})) << "a nozzle makes level 0 of HiRes";
  EXPECT_EQ(price(scene, {2, 3})->radii_m().size(), 4u);
  EXPECT_FALSE(acts(scene, {3, 3})) << "among one level a nozzle uses its particles again";
}

TEST(OwnLevels, AnEffectThatBecomesIdleLeavesNoTrace) {
  NEEDS_EFFECTS;
  const auto bare = fluid_of(small_dam(), MethodKind::LoRes);
  const auto turned = fluid_of(small_dam(), MethodKind::LoRes);
  turned->set_effects(effects_to(3));
  EXPECT_GT(turned->particle_bytes(), bare->particle_bytes());
  turned->set_effects(effects_to(2));
  EXPECT_EQ(price_of(*turned), price_of(*bare));
  EXPECT_EQ(turned->report().heat.held, 0);
}

TEST(OwnLevels, AnIdleEffectNeedsNoSubstepsThatTheOptionsRefuse) {
  NEEDS_EFFECTS;
  sim::SimulationOptions options;
  options.substeps = 2;
  EXPECT_THROW(fluid_of(small_dam(alone(EffectKind::Cohesion, 3)), MethodKind::LoRes, options), base::Error);
  const auto idle = fluid_of(small_dam(alone(EffectKind::Cohesion, 2)), MethodKind::LoRes, options);
  EXPECT_THAT(idle->explain(), HasSubstr("which ask for no shorter substeps"));
  options.method = MethodKind::LoRes;
  options.n_star = 64;
  EXPECT_EQ(sim::least_substeps(small_dam(alone(EffectKind::Cohesion, 2)), options), 2);
}

TEST(OwnLevels, StatesOfIdleEffectsResume) {
  NEEDS_EFFECTS;
  const test::TemporaryFolder folder;
  const auto scene = small_dam(effects_to(2));
  const auto through = fluid_of(scene, MethodKind::LoRes);
  through->step_frame();
  sim::SimulationOptions options;
  options.resume_from = folder.path() / "a.state";
  through->save_state(options.resume_from);
  const auto resumed = fluid_of(scene, MethodKind::LoRes, options);
  EXPECT_EQ(price_of(*resumed), price_of(*through));
  EXPECT_EQ(bits(resumed->read_state()), bits(through->read_state()));
}

// The next tests: stages that have nothing to do under a method's options are left out.

TEST(IdleStages, OneLevelMakesAMethodHiResToTheLastBit) {
  sim::SimulationOptions one;
  one.levels = 1;
  const auto hires = fluid_of(small_dam(), MethodKind::HiRes);
  const auto launches = launches_of(*hires, 6);
  for (const MethodKind method : {MethodKind::FovFluid, MethodKind::Ours}) {
    const auto fluid = fluid_of(small_dam(), method, one);
    for (const char* stage : {"saliency", "gaze targets", "graded targets", "split and merge", "ease"})
      EXPECT_THAT(fluid->explain(), HasSubstr(std::string("  -  ") + stage + ' '));
    EXPECT_FALSE(fluid->follows_picture());
    EXPECT_EQ(launches_of(*fluid, 6), launches);
    EXPECT_EQ(fluid->particle_bytes(), hires->particle_bytes());
    EXPECT_EQ(bits(fluid->read_state()), bits(hires->read_state()));
  }
}

TEST(IdleStages, OneLevelKeepsSaliencyForAnOutputAndSplitsCoarserStarts) {
  sim::SimulationOptions one;
  one.levels = 1;
  one.saliency_parts = true;
  const auto hires = fluid_of(small_dam(), MethodKind::HiRes);
  const auto shown = fluid_of(small_dam(), MethodKind::Ours, one);
  for (int frame = 0; frame < 6; ++frame) {
    hires->step_frame();
    shown->step_frame();
  }
  std::vector<sim::ParticleSaliency> saliency;
  shown->read_saliency(saliency);
  EXPECT_EQ(saliency.size(), 512u);
  EXPECT_THAT(shown->explain(), HasSubstr("an output asks for it"));
  EXPECT_EQ(bits(shown->read_state()), bits(hires->read_state()));

  one.start = hires->read_state();
  one.start->resize(1);
  one.start->front() = {.id = 0, .level = 1, .x_m = 1.2f, .y_m = 1, .z_m = 0.6f};
  const auto splits = fluid_of(small_dam(), MethodKind::Ours, one);
  for (int frame = 0; frame < 6; ++frame) splits->step_frame();
  EXPECT_EQ(splits->particle_count(), 2);
}

TEST(IdleStages, ATauWhoseBetaIsOneMakesOursTspOurs) {
  sim::SimulationOptions fixed, rate, live;
  fixed.temporal.fixed_tau = 0;
  rate.temporal.fixed_rate = sim::FrameRate{90, 1};
  const auto ours = fluid_of(small_dam(), MethodKind::Ours);
  const auto launches = launches_of(*ours, 6);
  for (const auto* options : {&fixed, &rate}) {
    const auto fluid = fluid_of(small_dam(), MethodKind::OursTsp, *options);
    EXPECT_EQ(launches_of(*fluid, 6), launches);
    EXPECT_EQ(fluid->particle_bytes(), ours->particle_bytes());
    EXPECT_EQ(bits(fluid->read_state()), bits(ours->read_state()));
    ASSERT_TRUE(fluid->account().temporal);
    EXPECT_GE(fluid->account().temporal->tau.value(), 0);
    EXPECT_EQ(fluid->account().temporal->rate.has_value(), options == &rate);
    EXPECT_EQ(fluid->account().temporal->beta, 1);
    EXPECT_EQ(fluid->account().temporal->active, fluid->particle_count());
  }
  EXPECT_GT(launches_of(*fluid_of(small_dam(), MethodKind::OursTsp, live), 6), launches)
      << "a measured tau may fall";
}

}  // namespace
