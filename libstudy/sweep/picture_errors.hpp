#pragma once
/// Errors of a sweep's stored pictures: differences from the reference's pictures at the same instants.

#include <array>
#include <vector>

#include "libstudy/sweep/cell_run.hpp"

namespace study {

/// In per cent, smaller is better; NaN if there are no pictures, or none before the parting.
enum class PictureError {
  Picture,  ///< E5: root mean square difference over 255; PSNR in dB is -20 log10 of it
  Fovea,    ///< E5: the same within the fovea
  Salient,  ///< E5: the same in the reference's most salient part outside the fovea
  Ssim,     ///< E5: 1 - SSIM
  Flip,     ///< E5: LDR-FLIP
  Film,     ///< E6: 1 - SSIM over the whole run
  Flicker   ///< E7: root mean square over the whole run of the difference between the two films' changes
            ///< within 1/30 s, over 255
};
inline constexpr std::size_t picture_error_count = 7;
using PictureErrors = std::array<double, picture_error_count>;

struct PictureScores {
  /// The first instant, in s, at which the reference and its twin, which starts an ulp away, differ by a
  /// third of the runs' median difference from the reference; infinity if there is none, NaN without
  /// pictures. E5 is over the instants before it.
  double parting_s = 0;
  std::vector<PictureErrors> errors;  ///< one per run
};

/// base::Error if pictures are damaged, or their instants or sizes differ from the reference's.
PictureScores score_pictures(const std::vector<const CellRun*>& runs, const CellRun& reference,
                             const CellRun& twin);

}  // namespace study
