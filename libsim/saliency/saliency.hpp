#pragma once
/// Visual saliency of particles, from eyes and fluid to target levels (paper 3.2): what persists between
/// frames and the two ways to a level.

#include "libsim/methods/method.hpp"
#include "libsim/saliency/features.hpp"
#include "libsim/saliency/gradients.hpp"

namespace sim::SIM_BACKEND {

/// What persists. It holds no memory until it is used.
struct SaliencyState {
  Readings readings;
  int levels = most_levels;  ///< N
  SaliencyInput input;
  SaliencyNormaliser normaliser;
  TemporalGradients gradients;
  Eyes eyes;                        ///< of the last evaluation
  Array<float> temporal, combined;  ///< f_T gamma_t of this frame alone, and F

  std::size_t bytes() const {
    return input.bytes() + gradients.bytes() + temporal.bytes() + combined.bytes();
  }
};

/// The fluid as saliency reads it, n particles in one order, and where the results go.
struct SaliencyFluid {
  const Vec4* position;
  const Vec4* velocity;
  const float* density;  ///< rho / rho_0
  const std::uint8_t* level;
  ParticleNeighbours neighbours;
  int n;
  float finest_support;  ///< h_*, m
  float gravity;         ///< m/s2
  float frame_dt;        ///< s
  float* unrest;  ///< f_T gamma_t followed over frames, NaN where not known yet; nullptr: this frame's alone
  float* saliency;
  std::uint8_t* target;
  SaliencyParts* parts;  ///< may be nullptr
  Guards* guards;
};

/// Eq. 1-9.
void evaluate_saliency(SaliencyState& state, const SaliencyFluid& fluid);
/// The gaze alone (FovFluid-like): the band is one support radius of the coarsest level wide.
void evaluate_gaze(SaliencyState& state, const SaliencyFluid& fluid);

}  // namespace sim::SIM_BACKEND
