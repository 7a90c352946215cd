#include "libsim/saliency/saliency.hpp"

#include <cmath>

namespace sim::SIM_BACKEND {

namespace {

GradientFields gradient_fields(const Readings& p, const SaliencyFluid& fluid, float* out) {
  // d_* = h_* / 2. The last term only keeps a fluid without gravity from 0 / 0.
  const double scale =
      std::sqrt(static_cast<double>(fluid.gravity) * static_cast<double>(fluid.finest_support) / 2);
  const auto speed_epsilon = static_cast<float>(p.speed_floor * scale + 1e-12);
  return {fluid.position, fluid.velocity, fluid.density, out, static_cast<float>(p.density_floor),
          speed_epsilon,  p.dimensionless};
}

/// What is not known yet starts with the frame's value, so that a NaN does not stay.
struct FollowUnrest {
  const float* now;
  float* unrest;
  float share;
  SIM_FN void operator()(int i) const {
    const float before = unrest[i];
    unrest[i] = std::isfinite(before) ? before + share * (now[i] - before) : now[i];
  }
};

}  // namespace

void evaluate_saliency(SaliencyState& state, const SaliencyFluid& fluid) {
  const Readings& p = state.readings;
  const auto size = static_cast<std::size_t>(fluid.n);
  state.temporal.resize(size);
  state.combined.resize(size);
  state.eyes = state.input.next_frame(static_cast<double>(fluid.frame_dt), p.gaze_hold_s);
  const GradientFields fields = gradient_fields(p, fluid, state.temporal.data());
  state.gradients.run(p.gradient, fields, fluid.neighbours, fluid.n, fluid.finest_support);
  if (fluid.unrest) {
    for_each("saliency unrest", fluid.n,
             FollowUnrest{state.temporal.data(), fluid.unrest, static_cast<float>(p.temporal_follow)});
  }
  const float* unrest = fluid.unrest ? fluid.unrest : state.temporal.data();
  combine_features(feature_numbers(p), state.eyes, fluid.position, unrest, state.combined.data(), fluid.parts,
                   fluid.n);
  state.normaliser.update(state.combined, fluid.level, fluid.n, p.normalisation,
                          static_cast<float>(p.saliency_floor));
  saliency_to_levels(state.combined.data(), state.normaliser.range(), state.levels, fluid.saliency,
                     fluid.target, fluid.guards, fluid.n);
}

void evaluate_gaze(SaliencyState& state, const SaliencyFluid& fluid) {
  const Readings& p = state.readings;
  state.eyes = state.input.next_frame(static_cast<double>(fluid.frame_dt), p.gaze_hold_s);
  const float coarsest_support =
      fluid.finest_support * std::cbrt(std::exp2(static_cast<float>(state.levels - 1)));
  gaze_to_levels(feature_numbers(p).acuity, state.eyes, fluid.position, coarsest_support, state.levels,
                 fluid.saliency, fluid.target, fluid.guards, fluid.n);
}

}  // namespace sim::SIM_BACKEND
