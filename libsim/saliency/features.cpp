#include "libsim/saliency/features.hpp"

#include <cmath>

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
      // A NaN takes precedence, so that it is detected.
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
  SIM_FN void operator()(int i) const {
    float s = 0;
    if (!std::isfinite(combined[i])) {
      atomic_add(&guards->saliency_not_finite, std::uint64_t{1});
    } else {
      if (!range->usable) return;
      s = fminf(fmaxf((combined[i] - range->low) / (range->high - range->low), 0.0f), 1.0f);
    }
    saliency[i] = s;
    target[i] = static_cast<std::uint8_t>(level_of_saliency(s, levels));
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
                        std::uint8_t* target, Guards* guards, int n) {
  for_each("saliency to levels", n, ToLevels{combined, range, levels, saliency, target, guards});
}

void gaze_to_levels(const Acuity& acuity, const Eyes& eyes, const Vec4* position, float band, int levels,
                    float* saliency, std::uint8_t* target, Guards* guards, int n) {
  for_each("gaze to levels", n, GazeToLevels{acuity, eyes, position, band, levels, saliency, target, guards});
}

}  // namespace sim::SIM_BACKEND
