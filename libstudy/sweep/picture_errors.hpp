#pragma once
/// Computes the errors of a sweep's stored pictures: differences from the reference's pictures at the same
/// instants.

#include <array>
#include <vector>

#include "libstudy/sweep/cell_run.hpp"

namespace study {

/// Errors of pictures in per cent; smaller is better; NaN without pictures. All but Flicker compare the first
/// picture of each pair in CellRun::pictures with the reference's. Picture, Fovea, Salient, Ssim and Flip use
/// the pictures before PictureScores::parting_s, from which on the reference's pictures are unpredictable;
/// Film and Flicker use the whole run. Fovea and Salient skip pictures whose mask has fewer than 100 pixels.
enum class PictureError {
  Picture,  ///< root mean square difference over 255; PSNR in dB is -20 log10 of this ratio
  Fovea,    ///< root mean square difference over 255 within the fovea
  Salient,  ///< root mean square difference over 255 in the reference's most salient part outside the fovea
  Ssim,     ///< mean of 1 - SSIM over the pictures before parting_s
  Flip,     ///< mean of LDR-FLIP
  Film,     ///< mean of 1 - SSIM over the whole run
  /// Root mean square difference over 255 between the change of the run's picture within a pair (1/30 s) and
  /// the change of the reference's picture.
  Flicker
};
inline constexpr std::size_t picture_error_count = 7;
using PictureErrors = std::array<double, picture_error_count>;

struct PictureScores {
  /// The instant, in s, from which the reference's pictures are unpredictable: the first at which reference
  /// and twin differ by a third of the runs' median difference from the reference. The twin is the reference
  /// started with a perturbation of one unit in the last place. Infinity if no such instant exists, NaN
  /// without pictures. PictureError says which errors use only the pictures before this instant.
  double parting_s = 0;
  std::vector<PictureErrors> errors;  ///< errors of each run
};

/// Computes the errors of `runs` against `reference`. `twin`: the reference from a perturbed start.
/// base::Error if pictures are damaged, or their instants or sizes differ from the reference's.
PictureScores score_pictures(const std::vector<const CellRun*>& runs, const CellRun& reference,
                             const CellRun& twin);

}  // namespace study
