#pragma once
/// Visual saliency of particles, from eyes and fluid to target levels (ViP-Fluid 3.2): F of each particle
/// (Eq. 1-3 and 5-8), from it s and the level (Eq. 9), the persistent state, and two ways to compute levels.

#include "libsim/methods/level_turns.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/particles/particles.hpp"
#include "libsim/saliency/gradients.hpp"
#include "libsim/saliency/input.hpp"
#include "libsim/saliency/normaliser.hpp"
#include "libsim/saliency/sight.hpp"

namespace sim::SIM_BACKEND {

/// Constants of ViP-Fluid Eq. 1-8 in the form that kernels use.
struct FeatureNumbers {
  Acuity acuity;
  Attenuation attenuation;
  float alpha;
  int window_max_px;
  bool manifold_occlusion;
  bool calm_out_of_view;
};
FeatureNumbers feature_numbers(const Readings& readings);

/// All features of one particle for one eye. `temporal` is f_T gamma_t: the temporal feature before it is
/// divided by gamma_t, the occlusion by water in front. The particle's radius is r = h / 4.
SIM_FN SaliencyParts evaluate(const FeatureNumbers& numbers, const Eye& eye, Vec4 particle, float temporal) {
  const Vec3 x = xyz(particle);
  const float r = 0.25f * particle.w;
  const float z = -eye.now(x).z;
  const Spot spot = find_spot(eye, x);
  const float attenuation = numbers.attenuation(spot, thickness(eye, spot, r));
  SaliencyParts out;
  out.acuity = numbers.acuity.feature(eye, x, z);
  // Particles behind the viewer are not visible. A NaN propagates into F; saliency_to_levels() counts it.
  out.manifold = z <= 0 ? 0
                        : manifold_feature(eye, spot, r, numbers.window_max_px) /
                              fmaxf(numbers.acuity.depth_factor(z), 1e-6f);
  if (numbers.manifold_occlusion) out.manifold /= attenuation;
  const bool unseen = numbers.calm_out_of_view && spot.kind == Spot::Kind::OutOfView;
  out.temporal = unseen ? 0 * temporal : temporal / attenuation;  // NaN if temporal is NaN
  out.combined = (1 - numbers.alpha) * (out.acuity + out.manifold) + numbers.alpha * out.temporal;
  return out;
}

/// F of every particle: the maximum over the eyes. `parts` may be nullptr.
void combine_features(const FeatureNumbers& numbers, const Eyes& eyes, const Vec4* position,
                      const float* temporal, float* combined, SaliencyParts* parts, int n);

/// Drops: particles of low density, alone or in threads and small groups. Their targets are at most their
/// levels, so that they do not merge: a merged drop is larger than the drops that it replaces, and the eye
/// sees each of them.
struct Drops {
  const float* density = nullptr;       ///< rho / rho_0
  const std::uint8_t* level = nullptr;  ///< of each particle
  float below = 0;                      ///< share of rho_0 below which a particle is one; 0: none is

  SIM_FN int at_most_own(int i, int target) const {
    return below > 0 && density[i] < below && level[i] < target ? level[i] : target;
  }
};

/// s and the target level from F. Particles whose F is not finite have s = 0 and are counted. If the range is
/// not usable, particles with a finite F keep s and target.
void saliency_to_levels(const float* combined, const SaliencyRange* range, int levels, float* saliency,
                        std::uint8_t* target, Guards* guards, Drops drops, int n);

/// s and the target level from the gaze alone (FovFluid-like): finest in the fovea of either eye, coarsest
/// outside, with a transition band of width `band` (m) between.
void gaze_to_levels(const Acuity& acuity, const Eyes& eyes, const Vec4* position, float band, int levels,
                    float* saliency, std::uint8_t* target, Guards* guards, int n);

/// State of saliency between frames. Allocates no memory until used.
struct SaliencyState {
  Readings readings;
  int levels = most_levels;  ///< N, number of levels
  SaliencyInput input;
  SaliencyNormaliser normaliser;
  TemporalGradients gradients;
  Eyes eyes;             ///< for the coming evaluation
  int frames_since = 0;  ///< frames since the temporal feature was measured; 0: never
  /// f_T gamma_t (the temporal feature before occlusion, not smoothed), and F
  Array<float> temporal, combined;

  /// Sets the eyes for the coming frame of dt_s seconds.
  void look_around(double dt_s) { eyes = input.next_frame(dt_s, readings.gaze_hold_s); }
  /// Calls look_around(), and decides whether this frame updates levels.
  void begin_frame(LevelTurns& turns, double dt_s);
  /// True if the coming evaluation measures the temporal feature.
  bool due() const { return frames_since == 0 || frames_since >= readings.temporal_period_frames; }
  std::size_t bytes() const {
    return input.bytes() + gradients.bytes() + temporal.bytes() + combined.bytes();
  }
};

/// Contribution of the water's rotation to saliency: a particle's share is 0 up to the rate `from`, 1/s, and
/// reaches 1 at twice this rate. Not in ViP-Fluid: its temporal feature has no such term.
struct SwirlSeen {
  const float* rate = nullptr;  ///< rate of rotation of each particle, 1/s; nullptr: no contribution
  float from = 0;
  float weight = 0;  ///< added to the temporal feature before occlusion (f_T gamma_t) at a share of 1

  SIM_FN float adds(int i) const {
    return weight * fminf(fmaxf(rate[i] - from, 0.0f) / fmaxf(from, 1e-6f), 1.0f);
  }
};

/// The fluid as input of saliency, n particles in one order, and the output arrays.
struct SaliencyFluid {
  const Vec4* position = nullptr;
  const Vec4* velocity = nullptr;
  /// rho / rho_0; read only if the temporal feature is measured or Readings::drop_density is above 0
  const float* density = nullptr;
  const std::uint8_t* level = nullptr;
  ParticleNeighbours neighbours{};
  int n = 0;
  float finest_support = 0;  ///< h_*, m
  float gravity = 0;         ///< m/s2; without gravity a substitute (FluidState::gravity_of_rest)
  /// the temporal feature before occlusion (f_T gamma_t), smoothed over frames, NaN if unknown; nullptr: no
  /// smoothing, only this frame's value is used.
  float* unrest = nullptr;
  SwirlSeen swirl{};  ///< added to `unrest`
  float* saliency = nullptr;
  std::uint8_t* target = nullptr;
  SaliencyParts* parts = nullptr;  ///< may be nullptr
  Guards* guards = nullptr;
};

/// s and target levels by ViP-Fluid Eq. 1-9. Without `unrest` in `fluid` the temporal feature is always
/// measured.
void evaluate_saliency(SaliencyState& state, const SaliencyFluid& fluid);
/// s and target levels from the gaze alone (FovFluid-like); the transition band is as wide as the support
/// radius of the coarsest level.
void evaluate_gaze(SaliencyState& state, const SaliencyFluid& fluid);

}  // namespace sim::SIM_BACKEND
