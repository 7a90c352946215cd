#pragma once
/// Structural similarity: Wang, Bovik, Sheikh and Simoncelli 2004.

#include <vector>

#include "stats/image/image.hpp"

namespace stats {

/// SSIM index of each pixel whose whole window lies in the picture. The window has 11 x 11 Gaussian weights
/// with sigma 1.5 px, summing to 1; luma of Rec. 601 (0.299, 0.587, 0.114) of the encoded bytes; K1 = 0.01,
/// K2 = 0.03, L = 255; variances and covariances are weighted like the means (biased). The pictures are not
/// downsampled.
struct SsimMap {
  static constexpr int border = 5;  ///< px on each side without an index
  int width = 0, height = 0;        ///< size of the map in px: that of the picture minus 2 border
  std::vector<double> index;        ///< -1 .. 1, row by row

  /// Mean over the map, or over the pixels of the mask (of the whole picture's size) that have an index.
  ImageScore mean(MaskView mask = {}) const;
};

/// Computes the SSIM index at each pixel. Pictures must be at least 11 x 11 px (std::invalid_argument).
SsimMap ssim_map(const ImageView& a, const ImageView& b);

}  // namespace stats
