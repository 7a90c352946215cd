#pragma once
/// Picture features for the frames observer, without a reference picture: live fluid is decorrelated from
/// every other run long before 30 s, so a distance to a reference would measure chaos.

#include "libstudy/protocol/design.hpp"

namespace study {

/// Means over the frames of one cell, on luminance 0 .. 1, pictures 640 pixels wide.
struct PictureFeatures {
  /// Size of the visible structures near the gaze, px: the characteristic wavelength 2 pi sqrt(<r^2> / <|grad
  /// r|^2>) of luminance less its mean over a window of 31 x 31 px, in the quarter of the fluid's pixels that
  /// is nearest to the gaze. Larger is coarser.
  double granularity_px = 0;
  /// Mean |L(t - 1) - 2 L(t) + L(t + 1)| of three successive frames over the fluid's pixels: uniform motion
  /// cancels in part, popping does not.
  double flicker = 0;
};

/// Returns the features of a cell; they do not depend on its timing.
class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  virtual PictureFeatures of(const StimulusSpec& stimulus) = 0;
};

/// Features from a table, for cells without pictures (source: feature_table.cpp): the three scenes at n_* =
/// 16k and 32k; other sizes use those of 16k. base::Error for a scene or method without a row.
class FeatureTable final : public FeatureSource {
 public:
  PictureFeatures of(const StimulusSpec& stimulus) override;
};

}  // namespace study
