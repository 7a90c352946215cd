#pragma once
/// Peak signal-to-noise ratio.

#include "stats/image/image.hpp"

namespace stats {

/// Mean of the squared differences of all three channels, in units of one step of the 8-bit encoding.
ImageScore mean_squared_error(const ImageView& a, const ImageView& b, MaskView mask = {});

/// 10 log10(255^2 / MSE) in dB, with the mean squared error (MSE) over the three encoded channels together.
/// Infinity if the pictures are equal.
ImageScore psnr_db(const ImageView& a, const ImageView& b, MaskView mask = {});

}  // namespace stats
