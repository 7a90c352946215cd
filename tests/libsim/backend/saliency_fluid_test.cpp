/// The whole of saliency (Eq. 1-9) on fluids from the solver.

#include <cstdio>
#include <limits>

#include "libsim/simulation.hpp"
#include "tests/libsim/backend/saliency_helpers.hpp"

namespace sim::SIM_BACKEND {
namespace {

using namespace saliency_test;

constexpr double d = 0.15;

/// 8,192 particles in a block at x = 0; in a longer tank it is a dam break.
struct Choice {
  double tank_length, block_length, height;
  int settle_frames, frames;
};
constexpr Choice still{32 * d, 32 * d, 16 * d, 120, 0};
constexpr Choice dam_break{64 * d, 16 * d, 32 * d, 0, 45};

struct State {
  std::vector<Vec4> position, velocity;
  Walls walls{};
};

std::unique_ptr<Simulation> make(const Choice& choice, MethodKind method) {
  Scene scene;
  scene.name = "tank";
  scene.tank_size_m = {choice.tank_length, 40 * d, 16 * d};
  scene.water.front().max_m = {choice.block_length, choice.height, 16 * d};
  scene.settle_frames = choice.settle_frames;
  SimulationOptions options;
  options.n_star = 1024;
#ifdef SIM_CUDA
  options.backend = Backend::Cuda;
#endif
  options.method = method;
  return sim::make_simulation(scene, options);
}

State run(const Choice& choice) {
  const auto fluid = make(choice, MethodKind::HiRes);
  for (int frame = 0; frame < choice.frames; ++frame) fluid->step_frame();
  State out;
  const auto h = static_cast<float>(2 * fluid->spacing_m());
  for (const auto& p : fluid->read_state()) {
    out.position.push_back({p.x_m, p.y_m, p.z_m, h});
    out.velocity.push_back({p.vx_m_s, p.vy_m_s, p.vz_m_s, 0});
  }
  const auto length = static_cast<float>(choice.tank_length), depth = static_cast<float>(16 * d);
  for (const Plane& wall :
       {Plane{{1, 0, 0}, 0}, {{-1, 0, 0}, -length}, {{0, 0, 1}, 0}, {{0, 0, -1}, -depth}, {{0, 1, 0}, 0}}) {
    out.walls.planes[out.walls.count++] = wall;
  }
  return out;
}

const State& still_water() {
  static const State state = run(still);
  return state;
}
const State& broken_dam() {
  static const State state = run(dam_break);
  return state;
}

/// A viewer in front of the tank, and the point that the viewer looks at; `scale` multiplies all lengths.
struct Looking {
  Vec3d eye, target;
  double scale = 1;
};
const Looking before_still{{16 * d, 14 * d, 16 * d + 2.5}, {16 * d, 10 * d, 8 * d}};
const Looking before_dam{{32 * d, 12 * d, 16 * d + 4}, {36 * d, 4 * d, 8 * d}};

struct Seen {
  Fluid fluid;
  GBuffer picture;
  Looks looks;
};

Seen prepare(const State& state, const Looking& from) {
  const auto f = static_cast<float>(from.scale);
  auto position = state.position;
  auto velocity = state.velocity;
  for (auto& p : position) p = {f * p.x, f * p.y, f * p.z, f * p.w};
  for (auto& v : velocity) v = {f * v.x, f * v.y, f * v.z, 0};
  Walls walls = state.walls;
  for (int k = 0; k < walls.count; ++k) walls.planes[k].offset *= f;
  const auto scaled = [&](const Vec3d& x) {
    return Vec3d{from.scale * x[0], from.scale * x[1], from.scale * x[2]};
  };
  Seen out{fluid_of(position, velocity, walls, position[0].w), {}, {}};
  out.fluid.state.parameters.gravity.strength *= f;
  const View view = view_of(scaled(from.eye), scaled(from.target), 480, 360);
  out.picture = splat(position, view, 1.5f);
  const Vec3d direction{from.target[0] - from.eye[0], from.target[1] - from.eye[1],
                        from.target[2] - from.eye[2]};
  out.looks.eyes = {{{scaled(from.eye), direction, true}, view, nullptr}};
  return out;
}

std::vector<int> levels_of(Seen& seen) {
  seen.looks.eyes[0].seen = &seen.picture;
  seen.fluid.saliency.input.look(seen.looks);
  seen.fluid.saliency.look_around(1.0 / 60);
  evaluate_saliency(seen.fluid.saliency, seen.fluid.view());
  return seen.fluid.levels();
}

void print_levels(const char* name, const std::vector<int>& levels) {
  int count[4] = {};
  for (const int level : levels) ++count[level];
  std::printf("%s: levels 0-3 hold %d %d %d %d\n", name, count[0], count[1], count[2], count[3]);
}

SIM_TEST(SaliencyOfFluids, StillWaterIsNotFinestOutsideTheFovea) {
  Seen seen = prepare(still_water(), before_still);
  const auto levels = levels_of(seen);
  print_levels("still water", levels);
  const Eye eye = seen.fluid.saliency.input.next_frame(1.0 / 60, 0.5).eye[0];
  const auto points = seen.fluid.points();
  float top = 0;
  for (const auto& p : points) top = std::max(top, p.y);
  int interior = 0, finest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool outside = Acuity::eccentricity(eye, xyz(points[i])) > Acuity::radians(7.5f);
    if (!outside || points[i].y > top - static_cast<float>(2 * d)) continue;
    ++interior;
    finest += levels[i] == 0;
  }
  std::printf("still water: %d of %d interior particles outside the fovea are at level 0\n", finest,
              interior);
  ASSERT_GT(interior, 4000);
  EXPECT_LT(finest, 0.05 * interior);
}

SIM_TEST(SaliencyOfFluids, FlowIsMeasuredInEverySecondFrameAndTheGazeInEach) {
  Seen seen = prepare(broken_dam(), before_dam);
  auto& particles = seen.fluid.state.particles;
  const auto n = static_cast<std::size_t>(particles.size());
  Array<float> unrest;
  unrest.from_host(std::vector<float>(n, std::numeric_limits<float>::quiet_NaN()));
  SaliencyFluid fluid = seen.fluid.view();
  fluid.unrest = unrest.data();
  seen.looks.eyes[0].seen = &seen.picture;
  const auto next = [&] {
    seen.fluid.saliency.input.look(seen.looks);
    seen.fluid.saliency.look_around(1.0 / 60);
    evaluate_saliency(seen.fluid.saliency, fluid);
    return unrest.to_host();
  };
  const auto first = next();
  for (const float value : first) ASSERT_TRUE(std::isfinite(value));
  const auto levels = seen.fluid.levels();
  // The water stops and the gaze jumps.
  particles.all().velocity.zero();
  seen.looks.eyes[0].gaze.direction[0] -= 20 * d;
  EXPECT_EQ(next(), first);
  EXPECT_NE(seen.fluid.levels(), levels);
  const auto third = next();
  double before = 0, after = 0;
  for (std::size_t i = 0; i < n; ++i) {
    before += static_cast<double>(first[i]);
    after += static_cast<double>(third[i]);
  }
  // In water that has stopped the feature's target comes from the density alone. The feature approaches it by
  // a fifth per frame, so at least 0.8^2 = 0.64 remains after at most two frames.
  EXPECT_LT(after, 0.95 * before);
  EXPECT_GT(after, 0.63 * before);
}

/// In the temporal feature swirl counts from the rate `from` on, fully at twice that, and fades over frames
/// as the rest of the feature does.
SIM_TEST(SaliencyOfFluids, SwirlAddsItsShareToTheTemporalFeature) {
  const auto unrest_with = [](SwirlSeen swirl, const std::vector<float>& rate, float before = 0.5f) {
    Seen seen = prepare(broken_dam(), before_dam);
    const auto n = static_cast<std::size_t>(seen.fluid.state.particles.size());
    Array<float> unrest, turns;
    unrest.from_host(std::vector<float>(n, before));
    std::vector<float> all;
    for (std::size_t i = 0; i < n; ++i) all.push_back(rate[i % rate.size()]);
    turns.from_host(all);
    swirl.rate = rate[0] < 0 ? nullptr : turns.data();
    SaliencyFluid fluid = seen.fluid.view();
    fluid.unrest = unrest.data();
    fluid.swirl = swirl;
    seen.looks.eyes[0].seen = &seen.picture;
    seen.fluid.saliency.input.look(seen.looks);
    seen.fluid.saliency.look_around(1.0 / 60);
    seen.fluid.saliency.frames_since = 2;
    evaluate_saliency(seen.fluid.saliency, fluid);
    return unrest.to_host();
  };
  const auto unseen = unrest_with({}, {-1});
  const auto seen = unrest_with({.from = 2, .weight = 5}, {0, 2, 3, 4, 1000});
  const float share[] = {0, 0, 0.5f, 1, 1};
  for (std::size_t i = 0; i < unseen.size(); ++i)
    EXPECT_NEAR(seen[i] - unseen[i], 0.36f * 5 * share[i % 5], 1e-4f) << i;
  // Without a value of the frame before, both parts of the feature start with the frame's own value.
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  const auto begun = unrest_with({.from = 2, .weight = 5}, {0, 2, 3, 4, 1000}, unknown);
  const auto begun_unseen = unrest_with({}, {-1}, unknown);
  for (std::size_t i = 0; i < begun.size(); ++i)
    EXPECT_NEAR(begun[i] - begun_unseen[i], 5 * share[i % 5], 1e-4f) << i;
  // With from = 0 every swirl counts, but zero swirl still adds nothing.
  const auto all = unrest_with({.from = 0, .weight = 1}, {0, 0.1f});
  EXPECT_EQ(all[0], unseen[0]);
  EXPECT_NEAR(all[1] - unseen[1], 0.36f, 1e-4f);
}

SIM_TEST(SaliencyOfFluids, LevelsDoNotDependOnTheUnitOfLength) {
  Seen seen = prepare(broken_dam(), before_dam);
  const auto levels = levels_of(seen);
  print_levels("dam break", levels);
  Looking large = before_dam;
  large.scale = 10;
  Seen tenfold = prepare(broken_dam(), large);
  tenfold.fluid.saliency.readings.image_plane_m *= 10;
  tenfold.fluid.saliency.readings.attenuation_per_m /= 10;
  const auto same = levels_of(tenfold);
  int changed = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) changed += levels[i] != same[i];
  EXPECT_LE(changed, 0.01 * static_cast<double>(levels.size()));
  // The test is meaningful only if every level occurs.
  for (int level = 0; level < 4; ++level) EXPECT_GT(std::count(levels.begin(), levels.end(), level), 40);
}

/// Spearman's correlation between the levels with this reach and those with Eq. 6's own reach, 2 h.
double agreement(const char* name, const State& water, const Looking& from, GradientReach reach) {
  Seen near = prepare(water, from);
  near.fluid.saliency.readings.gradient = reach;
  Seen wide = prepare(water, from);
  wide.fluid.saliency.readings.gradient = GradientReach::TwoSupports;
  const auto a = levels_of(near), b = levels_of(wide);
  print_levels("  its own reach", a);
  print_levels("  2 h", b);
  std::printf("%s: Spearman %.4f\n", name, spearman(a, b));
  return spearman(a, b);
}

SIM_TEST(SaliencyOfFluids, SmoothedGradientsRankAsThoseWithinTwoSupports) {
  // Plain gradients within h do not reach 0.95, so they are not the default.
  EXPECT_GE(agreement("dam break, smoothed", broken_dam(), before_dam, GradientReach::Smoothed), 0.95);
  EXPECT_LT(agreement("dam break, 1 h", broken_dam(), before_dam, GradientReach::OneSupport), 0.95);
  EXPECT_GE(agreement("still water, smoothed", still_water(), before_still, GradientReach::Smoothed), 0.95);
}

/// Runs a method with saliency from its own pictures, frame by frame.
void watch(Simulation& fluid, const Looking& from, int frames) {
  const View view = view_of(from.eye, from.target, 480, 360);
  const Vec3d direction{from.target[0] - from.eye[0], from.target[1] - from.eye[1],
                        from.target[2] - from.eye[2]};
  std::vector<RenderParticle> places;
  for (int frame = 0; frame < frames; ++frame) {
    fluid.read_particles(places);
    std::vector<Vec4> points;
    for (const auto& p : places) points.push_back({p.x_m, p.y_m, p.z_m, 4 * p.radius_m});
    const GBuffer picture = splat(points, view, 1.5f);
    fluid.look({{{{from.eye, direction, true}, view, &picture}}});
    fluid.step_frame();
  }
}

SIM_TEST(SaliencyOfFluids, StillWaterAsksForNoFineParticlesOutsideTheFovea) {
  // In a closed loop, changes of level stir the water a little, and stirred water is more salient.
  const auto fluid = make(still, MethodKind::Ours);
  watch(*fluid, before_still, 90);
  SaliencyInput input;
  const View view = view_of(before_still.eye, before_still.target, 480, 360);
  input.look({{{{before_still.eye, {0, 0, -1}, false}, view, nullptr}}});
  const Eye eye = input.next_frame(1.0 / 60, 0.5).eye[0];
  std::vector<RenderParticle> places;
  std::vector<ParticleSaliency> saliency;
  fluid->read_particles(places);
  fluid->read_saliency(saliency);
  ASSERT_EQ(places.size(), saliency.size());
  float top = 0;
  for (const auto& p : places) top = std::max(top, p.y_m);
  double mass = 0, asked = 0, held = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& p = places[i];
    const bool outside = Acuity::eccentricity(eye, {p.x_m, p.y_m, p.z_m}) > Acuity::radians(7.5f);
    if (!outside || p.y_m > top - static_cast<float>(2 * d)) continue;
    const double own = std::pow(static_cast<double>(p.radius_m) / (d / 2), 3);
    mass += own;
    if (level_of_saliency(saliency[i].s, 4) == 0) asked += own;
    if (own < 1.5) held += own;
  }
  std::printf(
      "still water after 90 frames: %zu of 8192 particles; of the interior mass %.3f asks for level 0, %.3f "
      "has it\n",
      places.size(), asked / mass, held / mass);
  // StillWaterIsNotFinestOutsideTheFovea allows 5 % in water at rest. Changes of level stir the water, so
  // that more of it asks for the finest level.
  EXPECT_LT(asked, 0.12 * mass);
  EXPECT_LT(places.size(), 5000u);
}

}  // namespace
}  // namespace sim::SIM_BACKEND
