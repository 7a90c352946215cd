#pragma once
/// Visual saliency of particles, from eyes and fluid to target levels (paper 3.2): what persists between
/// frames and the two ways to a level.

#include "libsim/methods/level_turns.hpp"
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
  Eyes eyes;                        ///< of the coming evaluation
  int frames_since = 0;             ///< the temporal feature was measured; 0: it never was
  Array<float> temporal, combined;  ///< f_T gamma_t of this frame alone, and F

  /// Where the eyes look in the coming frame of dt_s seconds.
  void look_around(double dt_s) { eyes = input.next_frame(dt_s, readings.gaze_hold_s); }
  /// The same, and whether levels have a turn in it.
  void begin_frame(LevelTurns& turns, double dt_s);
  /// Does the coming evaluation measure the temporal feature?
  bool due() const { return frames_since == 0 || frames_since >= readings.temporal_period_frames; }
  std::size_t bytes() const {
    return input.bytes() + gradients.bytes() + temporal.bytes() + combined.bytes();
  }
};

/// How the water turns, where saliency sees it: a particle's share is 0 up to `from`, 1/s, and 1 from twice
/// that on. Ours: the paper's temporal feature has no such term.
struct SwirlSeen {
  const float* rate = nullptr;  ///< 1/s; nullptr: not seen
  float from = 0;
  float weight = 0;  ///< what a share of 1 adds to f_T gamma_t

  SIM_FN float adds(int i) const {
    return weight * fminf(fmaxf(rate[i] - from, 0.0f) / fmaxf(from, 1e-6f), 1.0f);
  }
};

/// The fluid as saliency reads it, n particles in one order, and where the results go.
struct SaliencyFluid {
  const Vec4* position = nullptr;
  const Vec4* velocity = nullptr;
  const float* density = nullptr;  ///< rho / rho_0, where the temporal feature is due
  const std::uint8_t* level = nullptr;
  ParticleNeighbours neighbours{};
  int n = 0;
  float finest_support = 0;  ///< h_*, m
  float gravity = 0;         ///< m/s2
  /// f_T gamma_t followed over frames, NaN where not known yet; nullptr: this frame's alone.
  float* unrest = nullptr;
  SwirlSeen swirl{};  ///< goes into `unrest`
  float* saliency = nullptr;
  std::uint8_t* target = nullptr;
  SaliencyParts* parts = nullptr;  ///< may be nullptr
  Guards* guards = nullptr;
};

/// Eq. 1-9. Without `unrest` in `fluid` the temporal feature is measured whether it is due or not.
void evaluate_saliency(SaliencyState& state, const SaliencyFluid& fluid);
/// The gaze alone (FovFluid-like), from positions: the band is one support radius of the coarsest level wide.
void evaluate_gaze(SaliencyState& state, const SaliencyFluid& fluid);

}  // namespace sim::SIM_BACKEND
