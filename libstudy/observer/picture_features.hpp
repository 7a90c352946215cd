#pragma once
/// Picture features for the frames observer. They need no reference picture. Two runs of the same live fluid
/// become uncorrelated long before the end of a showing of 30 s, so a distance between their pictures would
/// measure only that chaos.

#include "libstudy/protocol/design.hpp"

namespace study {

/// Features of one cell: means over its measured pictures, which are 640 px wide, with luminance in 0 .. 1.
struct PictureFeatures {
  /// Size of the visible structures near the gaze, px; larger is coarser. It is the characteristic wavelength
  /// 2 pi sqrt(<r^2> / <|grad r|^2>). r is the luminance minus its mean over the fluid in a window of 31 x 31
  /// px; <> is the mean over the quarter of the fluid's pixels nearest to the gaze.
  double granularity_px = 0;
  /// Mean |L(t - 1) - 2 L(t) + L(t + 1)| over the fluid's pixels, with the luminance L of three successive
  /// frames. Uniform motion cancels in part; popping does not cancel.
  double flicker = 0;
};

/// Source of the picture features of cells. Cells with the same stimulus share their features, whatever their
/// frame rates are.
class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  virtual PictureFeatures of(const StimulusSpec& stimulus) = 0;
};

/// Features from the table in feature_table.cpp, for sessions without pictures. The table has the paper's
/// three scenes at n_* = 16k and 32k; every other n_* uses the values of 16k. base::Error for a scene or
/// method without a row.
class FeatureTable final : public FeatureSource {
 public:
  PictureFeatures of(const StimulusSpec& stimulus) override;
};

}  // namespace study
