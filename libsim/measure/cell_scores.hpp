#pragma once
/// The scores of Table 1 (how far each method's pictures differ from those of HiRes) per picture, and their
/// change since another run.

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "libsim/measure/scores.hpp"

namespace measure {

/// Metrics that compare one picture with that of HiRes, the reference method.
inline constexpr std::array still_metrics{Metric::PsnrFov, Metric::PsnrSalient, Metric::PsnrOverall,
                                          Metric::PsnrFluid, Metric::SsimStatic};

/// The key of one picture of Table 1.
struct CellKey {
  std::string scene, n_star, preset, method;
  int checkpoint = 0;  ///< frame of the checkpoint
  std::string start;   ///< checkpoint_digest(): pictures from different starts are not compared
  int gaze = 0;        ///< from 1, in the order of gaze_points
  int repeat = 0;      ///< from 1
  friend bool operator<(const CellKey& a, const CellKey& b) {
    const auto order = [](const CellKey& k) {
      return std::tie(k.scene, k.n_star, k.preset, k.method, k.checkpoint, k.start, k.gaze, k.repeat);
    };
    return order(a) < order(b);
  }
};
/// One value per metric of still_metrics. A PSNR is infinite if the compared pixels are equal; a value is NaN
/// if its mask is too small.
using CellValues = std::array<double, still_metrics.size()>;
using CellScores = std::map<CellKey, CellValues>;

/// One row per picture, with enough digits that read_cells() returns the same values bit for bit. A block
/// without values gives no rows.
figures::TextTable cell_rows(const std::vector<ScoreBlock>& blocks);

/// Reads the CSV of cell_rows(). base::Error at the file and its line.
CellScores read_cells(const std::filesystem::path& path);

/// base::Error unless the pictures of the blocks are exactly those of `then`. Compares keys only, not values;
/// ScoreBlock::starts must be filled in. `path` is the file of `then`.
void check_paired(const std::vector<ScoreBlock>& blocks, const CellScores& then, const std::string& path);

/// Mean of now - then with its 95 % interval (Student's t over pairs of checkpoint and gaze point, repeats
/// averaged first), one row per scene, n_*, preset, method and metric. Uses only pictures whose value is
/// finite in both runs.
figures::TextTable change_rows(const std::vector<ScoreBlock>& now, const CellScores& then);

}  // namespace measure
