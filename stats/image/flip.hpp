#pragma once
/// The difference that a viewer sees who flips between two pictures: LDR-FLIP of Andersson, Nilsson,
/// Akenine-Moeller, Oskarsson, Astrom and Fairchild 2020, with the Hunt adjustment and the HyAB distance.

#include "stats/image/image.hpp"

namespace stats {

/// Mean over the mask of the error of each pixel, 0 (none is seen) to 1. `pixels_per_degree`: of visual
/// angle, positive and at most 200; colours and features are filtered by what an eye resolves at that many.
/// Pixels beyond the border equal the nearest one on it. Either picture may come first. std::invalid_argument
/// as check_images, and for other pixels_per_degree.
ImageScore flip(const ImageView& a, const ImageView& b, double pixels_per_degree, MaskView mask = {});

}  // namespace stats
