#pragma once
/// The saliency F of each particle (paper Eq. 1-3 and 5-8), and from it s and the level (Eq. 9).

#include "libsim/particles/particles.hpp"
#include "libsim/saliency/acuity.hpp"
#include "libsim/saliency/input.hpp"
#include "libsim/saliency/normaliser.hpp"
#include "libsim/saliency/sight.hpp"

namespace sim::SIM_BACKEND {

/// Constants of Eq. 1-8 in the form that kernels use.
struct FeatureNumbers {
  Acuity acuity;
  Attenuation attenuation;
  float alpha;
  int window_max_px;
  bool manifold_occlusion;
  bool calm_out_of_view;
};
FeatureNumbers feature_numbers(const Readings& readings);

/// All features of one particle for one eye; `temporal` is f_T gamma_t. r = h / 4.
SIM_FN SaliencyParts evaluate(const FeatureNumbers& numbers, const Eye& eye, Vec4 particle, float temporal) {
  const Vec3 x = xyz(particle);
  const float r = 0.25f * particle.w;
  const float z = -eye.now(x).z;
  const Spot spot = find_spot(eye, x);
  const float attenuation = numbers.attenuation(spot, thickness(eye, spot, r));
  SaliencyParts out;
  out.acuity = numbers.acuity.feature(eye, x, z);
  // Particles behind the viewer are not visible. A NaN propagates into F and is counted there.
  out.manifold = z <= 0 ? 0
                        : manifold_feature(eye, spot, r, numbers.window_max_px) /
                              fmaxf(numbers.acuity.depth_factor(z), 1e-6f);
  if (numbers.manifold_occlusion) out.manifold /= attenuation;
  const bool unseen = numbers.calm_out_of_view && spot.kind == Spot::Kind::OutOfView;
  out.temporal = unseen ? 0 * temporal : temporal / attenuation;  // keeps NaN
  out.combined = (1 - numbers.alpha) * (out.acuity + out.manifold) + numbers.alpha * out.temporal;
  return out;
}

/// F of every particle: the maximum over the eyes. `parts` may be nullptr.
void combine_features(const FeatureNumbers& numbers, const Eyes& eyes, const Vec4* position,
                      const float* temporal, float* combined, SaliencyParts* parts, int n);

/// s and the target level from F. Particles whose F is not finite have s = 0 and are counted. If the range is
/// invalid, the finite particles keep s and target.
void saliency_to_levels(const float* combined, const SaliencyRange* range, int levels, float* saliency,
                        std::uint8_t* target, Guards* guards, int n);

/// s and the target level from the gaze alone (FovFluid-like): finest in the fovea of either eye, coarsest
/// outside, with a transition band of width `band` (m) between.
void gaze_to_levels(const Acuity& acuity, const Eyes& eyes, const Vec4* position, float band, int levels,
                    float* saliency, std::uint8_t* target, Guards* guards, int n);

}  // namespace sim::SIM_BACKEND
