#include "libsim/saliency/saliency.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/particles/calm.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct Combine {
  FeatureNumbers numbers;
  Eyes eyes;
  const Vec4* position;
  const float* temporal;
  float* combined;
  SaliencyParts* parts;
  SIM_FN void operator()(int i) const {
    SaliencyParts best{0, 0, 0, 0};
    for (int k = 0; k < eyes.count; ++k) {
      const SaliencyParts one = evaluate(numbers, eyes.eye[k], position[i], temporal[i]);
      // A NaN of the particle gives a NaN for each eye, so that it is detected.
      if (k == 0 || !(one.combined <= best.combined)) best = one;
    }
    combined[i] = best.combined;
    if (parts) parts[i] = best;
  }
};

struct ToLevels {
  const float* combined;
  const SaliencyRange* range;
  int levels;
  float* saliency;
  std::uint8_t* target;
  Guards* guards;
  Drops drops;
  SIM_FN void operator()(int i) const {
    float s = 0;
    if (!std::isfinite(combined[i])) {
      atomic_add(&guards->saliency_not_finite, std::uint64_t{1});
    } else {
      if (!range->usable) return;
      s = fminf(fmaxf((combined[i] - range->low) / (range->high - range->low), 0.0f), 1.0f);
    }
    saliency[i] = s;
    target[i] = static_cast<std::uint8_t>(drops.at_most_own(i, level_of_saliency(s, levels)));
  }
};

struct GazeToLevels {
  Acuity acuity;
  Eyes eyes;
  const Vec4* position;
  float band;
  int levels;
  float* saliency;
  std::uint8_t* target;
  Guards* guards;
  SIM_FN void operator()(int i) const {
    const Vec3 x = xyz(position[i]);
    float s = 0;
    if (!all_finite(x)) atomic_add(&guards->saliency_not_finite, std::uint64_t{1});
    for (int k = 0; k < eyes.count; ++k) s = fmaxf(s, acuity.gaze_saliency(eyes.eye[k], x, band));
    saliency[i] = s;
    target[i] = static_cast<std::uint8_t>(level_of_saliency(s, levels));
  }
};

}  // namespace

FeatureNumbers feature_numbers(const Readings& p) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {{p.falloff, f(p.fovea_half_angle_deg * 0.017453292519943295), f(p.image_plane_m)},
          {p.thickness, f(p.attenuation_per_m)},
          f(p.alpha),
          p.manifold_window_px,
          p.hide_manifold_behind,
          p.calm_out_of_view};
}

void combine_features(const FeatureNumbers& numbers, const Eyes& eyes, const Vec4* position,
                      const float* temporal, float* combined, SaliencyParts* parts, int n) {
  for_each("saliency features", n, Combine{numbers, eyes, position, temporal, combined, parts});
}

void saliency_to_levels(const float* combined, const SaliencyRange* range, int levels, float* saliency,
                        std::uint8_t* target, Guards* guards, Drops drops, int n) {
  for_each("saliency to levels", n, ToLevels{combined, range, levels, saliency, target, guards, drops});
}

void gaze_to_levels(const Acuity& acuity, const Eyes& eyes, const Vec4* position, float band, int levels,
                    float* saliency, std::uint8_t* target, Guards* guards, int n) {
  for_each("gaze to levels", n, GazeToLevels{acuity, eyes, position, band, levels, saliency, target, guards});
}

namespace {

GradientFields gradient_fields(const Readings& p, const SaliencyFluid& fluid, float* out) {
  // d_* = h_* / 2. The last term only prevents 0 / 0 for a particle at rest if speed_floor is 0.
  const double scale =
      std::sqrt(static_cast<double>(fluid.gravity) * static_cast<double>(fluid.finest_support) / 2);
  const auto speed_epsilon = static_cast<float>(p.speed_floor * scale + 1e-12);
  return {fluid.position, fluid.velocity, fluid.density, out, static_cast<float>(p.density_floor),
          speed_epsilon,  p.dimensionless};
}

/// Smooths the temporal feature over frames. In water at rest only the excess over `floor` counts; the floor
/// falls to 0 as the speed rises, so that no level depends on one threshold speed. The floor is not
/// subtracted from the part by swirl (rotation of the water), which is 0 up to the rate SwirlSeen::from
/// anyway. A smoothed value that is not finite is replaced by this frame's value, so that a NaN does not
/// persist.
struct FollowUnrest {
  const float* now;
  float* unrest;
  const Vec4* velocity;
  SwirlSeen swirl;
  LevelRest rest;
  float share, floor;
  SIM_FN void operator()(int i) const {
    const float before = unrest[i];
    const float lowered = floor * rest(velocity[i]);
    // A NaN is not < lowered and passes, so that it is detected.
    float wish = now[i] < lowered ? 0 : now[i] - lowered;
    if (swirl.rate) wish += swirl.adds(i);
    unrest[i] = std::isfinite(before) ? before + share * (wish - before) : wish;
  }
};

/// The share of one step that replaces `steps` steps of `share` each; steps below 1 count as 1.
float in_one_step(double share, int steps) {
  return static_cast<float>(1 - std::pow(1 - share, std::max(steps, 1)));
}

/// Measures f_T gamma_t of this frame, the temporal feature before occlusion, and updates its smoothed value.
void measure_unrest(SaliencyState& state, const SaliencyFluid& fluid) {
  const Readings& p = state.readings;
  state.temporal.resize(static_cast<std::size_t>(fluid.n));
  const GradientFields fields = gradient_fields(p, fluid, state.temporal.data());
  state.gradients.run(p.gradient, fields, fluid.neighbours, fluid.n, fluid.finest_support);
  if (fluid.unrest) {
    for_each("saliency unrest", fluid.n,
             FollowUnrest{
                 .now = state.temporal.data(),
                 .unrest = fluid.unrest,
                 .velocity = fluid.velocity,
                 .swirl = fluid.swirl,
                 .rest = {calm_below(LevelRest::fades_at * p.calm_speed, static_cast<double>(fluid.gravity),
                                     static_cast<double>(fluid.finest_support) / 2)},
                 .share = in_one_step(p.temporal_follow, state.frames_since),
                 .floor = static_cast<float>(p.calm_floor)});
  }
}

}  // namespace

void SaliencyState::begin_frame(LevelTurns& turns, double dt_s) {
  turns.begin_frame(readings, input.turned_deg());
  look_around(dt_s);
  if (turns.due) input.mark_gazes(readings.gaze_hold_s);
}

void evaluate_saliency(SaliencyState& state, const SaliencyFluid& fluid) {
  const Readings& p = state.readings;
  state.combined.resize(static_cast<std::size_t>(fluid.n));
  const bool anew = !fluid.unrest || state.due();
  if (anew) measure_unrest(state, fluid);
  const float* unrest = fluid.unrest ? fluid.unrest : state.temporal.data();
  combine_features(feature_numbers(p), state.eyes, fluid.position, unrest, state.combined.data(), fluid.parts,
                   fluid.n);
  if (anew) {
    state.normaliser.update(state.combined, fluid.level, fluid.n, p.normalisation,
                            in_one_step(SaliencyNormaliser::follow, state.frames_since),
                            static_cast<float>(p.saliency_floor));
  }
  state.frames_since = anew ? 1 : state.frames_since + 1;
  saliency_to_levels(state.combined.data(), state.normaliser.range(), state.levels, fluid.saliency,
                     fluid.target, fluid.guards,
                     {fluid.density, fluid.level, static_cast<float>(p.drop_density)}, fluid.n);
}

void evaluate_gaze(SaliencyState& state, const SaliencyFluid& fluid) {
  const Readings& p = state.readings;
  const float coarsest_support =
      fluid.finest_support * std::cbrt(std::exp2(static_cast<float>(state.levels - 1)));
  gaze_to_levels(feature_numbers(p).acuity, state.eyes, fluid.position, coarsest_support, state.levels,
                 fluid.saliency, fluid.target, fluid.guards, fluid.n);
}

}  // namespace sim::SIM_BACKEND
