/// Effects that start and stop while the water runs, and the time of each pass.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <numeric>

#include "tests/common/needs_effects.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/libsim/fluid_helpers.hpp"

namespace {

using sim::Backend;
using sim::EffectKind;
using sim::EffectOption;
using sim::MethodKind;
using testing::HasSubstr;
using testing::Not;

void set(sim::Effect& effect, EffectOption option, double value) {
  effect.options[static_cast<std::size_t>(option)] = value;
}

/// Five effects. Heat adds a temperature to each particle, and foam has particles of its own.
std::vector<sim::Effect> several() {
  sim::Effect foam{EffectKind::Foam, 20};
  set(foam, EffectOption::FoamEnergyFrom, 0.05);
  set(foam, EffectOption::FoamEnergySpan, 0.5);
  set(foam, EffectOption::FoamDiameter, 0.03);
  set(foam, EffectOption::FoamMost, 2000);
  return {{EffectKind::Viscosity, 0.02},
          {EffectKind::Cohesion, 400},
          {EffectKind::AirDrag, 1},
          {EffectKind::Heat, 0.02},
          foam};
}

std::vector<sim::Effect> without(EffectKind kind) {
  auto out = several();
  std::erase_if(out, [&](const sim::Effect& effect) { return effect.kind == kind; });
  return out;
}

sim::Scene dam(std::vector<sim::Effect> effects = {}) {
  auto scene = fluid_test::tank({2.4, 2, 1.2}, {1.2, 1.2, 1.2});
  scene.v_ref_m_s = 5;
  scene.viscosity_m2_s = 0.005;
  scene.warm = {{{-1, -1, -1}, {0.6, 3, 3}, 320}};
  scene.effects = std::move(effects);
  return scene;
}

sim::SimulationOptions options_of(Backend backend, MethodKind method) {
  sim::SimulationOptions out;
  out.backend = backend;
  out.method = method;
  out.n_star = 64;
  if (sim::traits_of(method).temporal) out.temporal.fixed_tau = -20;
  return out;
}

void run(sim::Simulation& fluid, int frames) {
  for (int k = 0; k < frames; ++k) fluid.step_frame();
}

template <class T>
std::string bits(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string foam_of(const sim::Simulation& fluid) {
  std::vector<sim::RenderParticle> out;
  fluid.read_foam(out);
  return bits(out);
}
std::vector<float> temperatures(const sim::Simulation& fluid) {
  std::vector<float> out;
  fluid.read_field(sim::ParticleField::Temperature, out);
  return out;
}

/// The schedule in words, without the line that gives the number of bytes.
std::string schedule_of(const sim::Simulation& fluid) {
  const std::string all = fluid.explain();
  return all.substr(all.find('\n'));
}

void expect_alike(sim::Simulation& a, sim::Simulation& b) {
  EXPECT_EQ(bits(a.read_state()), bits(b.read_state()));
  EXPECT_EQ(foam_of(a), foam_of(b));
  EXPECT_EQ(bits(temperatures(a)), bits(temperatures(b)));
  EXPECT_EQ(schedule_of(a), schedule_of(b));
  EXPECT_EQ(a.substeps().taken, b.substeps().taken);
}

void on_and_off_at_once_leave_no_trace(Backend backend) {
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    const auto bare = sim::make_simulation(dam(), options_of(backend, method.kind));
    const auto turned = sim::make_simulation(dam(), options_of(backend, method.kind));
    run(*bare, 5);
    run(*turned, 5);
    turned->set_effects(several());
    turned->set_effects({});
    run(*bare, 8);
    run(*turned, 8);
    expect_alike(*bare, *turned);
    EXPECT_EQ(bare->particle_bytes(), turned->particle_bytes());
  }
}
TEST(LiveEffects, OnAndOffAtOnceLeaveNoTrace) {
  NEEDS_EFFECTS;
  on_and_off_at_once_leave_no_trace(Backend::Cpu);
}
TEST(LiveEffectsGpu, OnAndOffAtOnceLeaveNoTrace) {
  NEEDS_EFFECTS;
  on_and_off_at_once_leave_no_trace(Backend::Cuda);
}

/// A run that changes from effects `before` to `after` must continue like one that has had `after` since the
/// state of the change.
void goes_on_as_one_that_had(const std::vector<sim::Effect>& before, const std::vector<sim::Effect>& after,
                             Backend backend) {
  const test::TemporaryFolder folder;
  for (const auto& method : sim::all_methods()) {
    SCOPED_TRACE(method.name);
    auto options = options_of(backend, method.kind);
    const auto turned = sim::make_simulation(dam(before), options);
    run(*turned, 12);
    const auto water = turned->read_state();
    turned->set_effects(after);
    EXPECT_EQ(bits(turned->read_state()), bits(water));
    turned->save_state(folder / "state");
    options.resume_from = folder / "state";
    const auto other = sim::make_simulation(dam(after), options);
    run(*turned, 12);
    run(*other, 12);
    expect_alike(*turned, *other);
    // With splits, the passes' buffers stay as large as at their maximum.
    if (!method.adaptive()) {
      EXPECT_EQ(turned->particle_bytes(), other->particle_bytes());
    }
    EXPECT_NE(bits(turned->read_state()), bits(water));
  }
}
void goes_on_as_if_never_there(Backend backend) {
  goes_on_as_one_that_had(several(), {}, backend);
  goes_on_as_one_that_had(several(), without(EffectKind::Heat), backend);
}
TEST(LiveEffects, WithoutThemTheWaterGoesOnAsIfTheyHadNeverBeenThere) {
  NEEDS_EFFECTS;
  goes_on_as_if_never_there(Backend::Cpu);
}
TEST(LiveEffectsGpu, WithoutThemTheWaterGoesOnAsIfTheyHadNeverBeenThere) {
  NEEDS_EFFECTS;
  goes_on_as_if_never_there(Backend::Cuda);
}
TEST(LiveEffects, WithThemTheWaterGoesOnAsIfTheyHadAlwaysBeenThere) {
  NEEDS_EFFECTS;
  goes_on_as_one_that_had({}, several(), Backend::Cpu);
}
TEST(LiveEffectsGpu, WithThemTheWaterGoesOnAsIfTheyHadAlwaysBeenThere) {
  NEEDS_EFFECTS;
  goes_on_as_one_that_had({}, several(), Backend::Cuda);
}

/// Before the first frame, set_effects gives the same simulation as a scene that lists these effects,
/// including limits that take effect only later: a fast particle shows the guard's speed limit.
void at_the_start_are_the_scenes(Backend backend) {
  for (const auto& [before, after] : {std::pair{std::vector<sim::Effect>{}, several()}, {several(), {}}}) {
    const auto turned = sim::make_simulation(dam(before), options_of(backend, MethodKind::OursTsp));
    turned->set_effects(after);
    const auto listed = sim::make_simulation(dam(after), options_of(backend, MethodKind::OursTsp));
    EXPECT_EQ(turned->explain(), listed->explain());
    auto bullet = listed->read_state()[0];
    bullet.vx_m_s = 1000;
    for (const auto& fluid : {turned.get(), listed.get()}) {
      fluid->put({bullet});
      run(*fluid, 10);
      EXPECT_GT(fluid->report().guards.speed_limited, 0u);
    }
    expect_alike(*turned, *listed);
  }
}
TEST(LiveEffects, AtTheStartAreTheScenes) {
  NEEDS_EFFECTS;
  at_the_start_are_the_scenes(Backend::Cpu);
}
TEST(LiveEffectsGpu, AtTheStartAreTheScenes) {
  NEEDS_EFFECTS;
  at_the_start_are_the_scenes(Backend::Cuda);
}

void what_stays_keeps_its_own(Backend backend) {
  const auto fluid = sim::make_simulation(dam(several()), options_of(backend, MethodKind::Ours));
  run(*fluid, 30);
  const std::string foam = foam_of(*fluid);
  const auto warm = temperatures(*fluid);
  const auto emitted = fluid->report().foam.emitted;
  const double held = fluid->report().heat.held;
  ASSERT_GT(foam.size(), 20 * sizeof(sim::RenderParticle));
  fluid->set_effects(without(EffectKind::Cohesion));
  EXPECT_EQ(foam_of(*fluid), foam);
  EXPECT_EQ(bits(temperatures(*fluid)), bits(warm));
  EXPECT_EQ(fluid->report().foam.emitted, emitted);
  run(*fluid, 5);
  EXPECT_NEAR(fluid->report().heat.held / held, 1, 1e-5);
  // An effect that stops discards its data and starts empty again.
  fluid->set_effects(without(EffectKind::Foam));
  EXPECT_EQ(fluid->foam_capacity(), 0);
  EXPECT_EQ(fluid->report().foam.emitted, 0u);
  run(*fluid, 1);
  fluid->set_effects(several());
  EXPECT_EQ(fluid->foam_capacity(), 2000);
  EXPECT_EQ(foam_of(*fluid), "");
  fluid->set_effects(without(EffectKind::Heat));
  EXPECT_EQ(fluid->report().heat.held, 0);
  fluid->set_effects(several());
  std::vector<sim::RenderParticle> water;
  fluid->read_particles(water);
  const auto anew = temperatures(*fluid);
  ASSERT_EQ(anew.size(), water.size());
  for (std::size_t i = 0; i < anew.size(); ++i)
    EXPECT_NEAR(anew[i], water[i].x_m < 0.6f ? 320 - 293.15 : 0, 1e-3);
}
TEST(LiveEffects, WhatStaysKeepsItsOwnAndWhatComesBackBeginsAnew) {
  NEEDS_EFFECTS;
  what_stays_keeps_its_own(Backend::Cpu);
}
TEST(LiveEffectsGpu, WhatStaysKeepsItsOwnAndWhatComesBackBeginsAnew) {
  NEEDS_EFFECTS;
  what_stays_keeps_its_own(Backend::Cuda);
}

TEST(LiveEffects, SubstepsFollowTheirSteps) {
  NEEDS_EFFECTS;
  const auto fluid = sim::make_simulation(dam(), options_of(Backend::Cpu, MethodKind::HiRes));
  run(*fluid, 3);
  const int usual = fluid->substeps().taken;
  fluid->set_effects({{EffectKind::Cohesion, 10'000}});
  const double longest = sim::longest_step({{EffectKind::Cohesion, 10'000}}, fluid->spacing_m()).seconds;
  run(*fluid, 1);
  EXPECT_GT(fluid->substeps().taken, usual);
  EXPECT_LE(dam().frame_dt_s / fluid->substeps().taken, longest * (1 + 1e-9));
  fluid->set_effects({{EffectKind::Cohesion, 1}});
  run(*fluid, 3);
  EXPECT_EQ(fluid->substeps().taken, usual);
}

TEST(LiveEffects, WhatIsRefusedChangesNothing) {
  NEEDS_EFFECTS;
  auto options = options_of(Backend::Cpu, MethodKind::Ours);
  options.substeps = 4;
  const auto fluid = sim::make_simulation(dam(several()), options);
  const auto calm = sim::make_simulation(dam(several()), options);
  run(*fluid, 10);
  run(*calm, 10);
  const auto refused = [&](std::vector<sim::Effect> effects, const std::string& why) {
    EXPECT_THAT([&] { fluid->set_effects(effects); }, testing::ThrowsMessage<base::Error>(HasSubstr(why)));
  };
  refused({{EffectKind::Cohesion, 10'000}}, "4 were asked for");
  refused({{EffectKind::Adhesion, 1}}, "needs cohesion");
  refused({{EffectKind::Cohesion, -1}}, "out of range");
  refused({{EffectKind::AirDrag, 1}, {EffectKind::AirDrag, 1}}, "listed twice");
  sim::Effect foam{EffectKind::Foam, 1e5};
  set(foam, EffectOption::FoamDiameter, 1e-4);
  refused({foam}, "raise diameter_m");
  run(*fluid, 5);
  run(*calm, 5);
  expect_alike(*fluid, *calm);
}

void the_account_of_momentum_closes(Backend backend) {
  auto options = options_of(backend, MethodKind::Ours);
  options.wall_impulse = true;
  const auto fluid = sim::make_simulation(dam(), options);
  double gave[2] = {};
  for (int frame = 0; frame < 24; ++frame) {
    const bool on = frame / 6 % 2 == 1;
    fluid->set_effects(on ? several() : std::vector<sim::Effect>{});
    fluid->step_frame();
    const auto a = fluid->momentum();
    const auto walls = a.walls_sum();
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(a.after[k],
                  a.before[k] + a.forces[k] + walls[k] + a.flow[k] + a.levels[k] + a.braked[k] +
                      a.viscosity[k] + a.effects[k] + a.inherited[k] + a.unattributed[k],
                  1e-3);
      gave[on] += std::abs(a.effects[k]);
    }
  }
  EXPECT_EQ(gave[0], 0);
  EXPECT_GT(gave[1], 1);
}
TEST(LiveEffects, TheAccountOfMomentumCloses) {
  NEEDS_EFFECTS;
  the_account_of_momentum_closes(Backend::Cpu);
}
TEST(LiveEffectsGpu, TheAccountOfMomentumCloses) {
  NEEDS_EFFECTS;
  the_account_of_momentum_closes(Backend::Cuda);
}

double sum_of(const std::vector<sim::StageTime>& passes) {
  return std::accumulate(passes.begin(), passes.end(), 0.0,
                         [](double sum, const auto& pass) { return sum + pass.ms; });
}

void passes_are_those_that_run(Backend backend) {
  const auto fluid = sim::make_simulation(dam(), options_of(backend, MethodKind::Ours));
  const auto plain = sim::make_simulation(dam(), options_of(backend, MethodKind::Ours));
  run(*fluid, 2);
  EXPECT_EQ(sum_of(fluid->passes()), 0) << "nobody asked";
  fluid->time_passes(true);
  EXPECT_EQ(sum_of(fluid->passes()), 0) << "no frame yet";
  run(*fluid, 2);
  // Each pass has a time, with the names and in the order of --explain.
  std::size_t at = 0;
  const std::string explained = fluid->explain();
  for (const auto& pass : fluid->passes()) {
    EXPECT_GT(pass.ms, 0) << pass.name;
    at = explained.find("  " + pass.phase + " ", at);
    ASSERT_NE(at, std::string::npos) << pass.name;
    EXPECT_EQ(explained.compare(explained.find_first_not_of(' ', at + 2 + pass.phase.size()),
                                pass.name.size(), pass.name),
              0)
        << pass.name;
    ++at;
  }
  const auto bare = fluid->passes().size();
  run(*plain, 4);
  EXPECT_EQ(bits(fluid->read_state()), bits(plain->read_state())) << "the clock only looks";
  if (sim::has_effects()) {
    fluid->set_effects({{EffectKind::AirDrag, 1}});
    EXPECT_EQ(sum_of(fluid->passes()), 0) << "of the new schedule nothing was measured";
    run(*fluid, 1);
    const auto passes = fluid->passes();
    ASSERT_EQ(passes.size(), bare + 1);
    const auto drag = std::find_if(passes.begin(), passes.end(),
                                   [](const auto& pass) { return pass.effect == EffectKind::AirDrag; });
    ASSERT_NE(drag, passes.end());
    EXPECT_EQ(drag->phase, "substep end");
    EXPECT_GT(drag->ms, 0);
  }
  fluid->time_passes(false);
  run(*fluid, 1);
  EXPECT_EQ(sum_of(fluid->passes()), 0);
}
TEST(PassTimes, AreOfThePassesThatRun) { passes_are_those_that_run(Backend::Cpu); }
TEST(PassTimesGpu, AreOfThePassesThatRun) { passes_are_those_that_run(Backend::Cuda); }

TEST(PassTimes, MakeUpTheFrame) {
  auto options = options_of(Backend::Cpu, MethodKind::Ours);
  options.time_parts = true;
  const auto fluid = sim::make_simulation(dam(), options);
  fluid->time_passes(true);
  run(*fluid, 5);
  const auto parts = fluid->part_times();
  const double whole = parts.saliency_ms + parts.levels_ms + parts.activation_ms + parts.solve_ms;
  EXPECT_NEAR(sum_of(fluid->passes()) / whole, 1, 0.1);
}

}  // namespace
