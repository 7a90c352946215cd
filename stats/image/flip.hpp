#pragma once
/// LDR-FLIP, the difference that a viewer sees when flipping between two pictures (Andersson, Nilsson,
/// Akenine-Moeller, Oskarsson, Astrom and Fairchild 2020), with the Hunt adjustment and the HyAB distance.

#include "stats/image/image.hpp"

namespace stats {

/// Mean over the mask of each pixel's error, 0 (invisible) to 1. `pixels_per_degree` of visual angle must be
/// positive and at most 200; colours and features are filtered to what the eye resolves at that resolution.
/// Outside the picture the filters read the nearest pixel on its border. The result does not depend on the
/// order of the pictures. std::invalid_argument where check_images throws it, and if pixels_per_degree is out
/// of range.
ImageScore flip(const ImageView& a, const ImageView& b, double pixels_per_degree, MaskView mask = {});

}  // namespace stats
