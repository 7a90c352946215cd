#pragma once
/// What the kept pictures of a sweep tell: how far each run's are from the reference's at the same instants.

#include <array>
#include <vector>

#include "apps/common/sweep/cell_run.hpp"

namespace apps {

/// In per cent, smaller is better; NaN where there are no pictures, or none before the parting.
enum class PictureError {
  Picture,  ///< E5: root mean square difference over 255; PSNR in dB is -20 log10 of it
  Fovea,    ///< E5: the same where the gaze's fovea is
  Salient,  ///< E5: the same where the reference is most salient beyond the fovea
  Ssim,     ///< E5: 1 - SSIM
  Flip,     ///< E5: LDR-FLIP
  Film,     ///< E6: 1 - SSIM over the whole run
  Flicker   ///< E7: root mean square of the changes within 1/30 s that one film has and the other has not,
            ///< over 255, over the whole run
};
inline constexpr std::size_t picture_error_count = 7;
using PictureErrors = std::array<double, picture_error_count>;

struct PictureScores {
  /// The first instant at which the reference and its twin, an ulp away at the start, differ by a third of
  /// the runs' median difference from the reference, s; infinity where there is none, NaN without pictures.
  /// E5 is over the instants before.
  double parting_s = 0;
  std::vector<PictureErrors> errors;  ///< one a run
};

/// base::Error where pictures are damaged, or of other instants or sizes than the reference's.
PictureScores score_pictures(const std::vector<const CellRun*>& runs, const CellRun& reference,
                             const CellRun& twin);

}  // namespace apps
