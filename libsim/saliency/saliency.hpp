#pragma once
/// Visual saliency of particles, from eyes and fluid to target levels (paper 3.2): the persistent state and
/// two ways to compute levels.

#include "libsim/methods/level_turns.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/saliency/features.hpp"
#include "libsim/saliency/gradients.hpp"

namespace sim::SIM_BACKEND {

/// Persistent state. Allocates no memory until used.
struct SaliencyState {
  Readings readings;
  int levels = most_levels;  ///< N
  SaliencyInput input;
  SaliencyNormaliser normaliser;
  TemporalGradients gradients;
  Eyes eyes;                        ///< of the coming evaluation
  int frames_since = 0;             ///< frames since the temporal feature was measured; 0: never
  Array<float> temporal, combined;  ///< f_T gamma_t of this frame only, and F

  /// Sets the eyes for the coming frame of dt_s seconds.
  void look_around(double dt_s) { eyes = input.next_frame(dt_s, readings.gaze_hold_s); }
  /// The same, and decides whether this frame updates levels.
  void begin_frame(LevelTurns& turns, double dt_s);
  /// True if the coming evaluation measures the temporal feature.
  bool due() const { return frames_since == 0 || frames_since >= readings.temporal_period_frames; }
  std::size_t bytes() const {
    return input.bytes() + gradients.bytes() + temporal.bytes() + combined.bytes();
  }
};

/// Contribution of the water's rotation to saliency: a particle's share is 0 up to the rate `from`, 1/s, and
/// reaches 1 at twice that. Not in the paper: its temporal feature has no such term.
struct SwirlSeen {
  const float* rate = nullptr;  ///< 1/s; nullptr: not used
  float from = 0;
  float weight = 0;  ///< added to f_T gamma_t at a share of 1

  SIM_FN float adds(int i) const {
    return weight * fminf(fmaxf(rate[i] - from, 0.0f) / fmaxf(from, 1e-6f), 1.0f);
  }
};

/// The fluid as input of saliency, n particles in one order, and the output arrays.
struct SaliencyFluid {
  const Vec4* position = nullptr;
  const Vec4* velocity = nullptr;
  const float* density = nullptr;  ///< rho / rho_0, if the temporal feature is due
  const std::uint8_t* level = nullptr;
  ParticleNeighbours neighbours{};
  int n = 0;
  float finest_support = 0;  ///< h_*, m
  float gravity = 0;         ///< m/s2
  /// f_T gamma_t smoothed over frames, NaN if unknown; nullptr: use only this frame's.
  float* unrest = nullptr;
  SwirlSeen swirl{};  ///< added to `unrest`
  float* saliency = nullptr;
  std::uint8_t* target = nullptr;
  SaliencyParts* parts = nullptr;  ///< may be nullptr
  Guards* guards = nullptr;
};

/// Eq. 1-9. Without `unrest` in `fluid` the temporal feature is always measured.
void evaluate_saliency(SaliencyState& state, const SaliencyFluid& fluid);
/// Gaze only (FovFluid-like), from positions: the band is one support radius of the coarsest level wide.
void evaluate_gaze(SaliencyState& state, const SaliencyFluid& fluid);

}  // namespace sim::SIM_BACKEND
