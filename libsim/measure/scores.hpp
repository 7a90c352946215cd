#pragma once
/// Table 1 as numbers: the scores of each method, their means and the paired differences.

#include <array>
#include <string>
#include <vector>

#include "libsim/measure/cells.hpp"
#include "stats/image/image.hpp"

namespace measure {

enum class Metric {
  PsnrFov,
  PsnrSalient,
  PsnrOverall,
  PsnrFluid,
  SsimStatic,
  SsimCumul,
  Flicker,
  FlickerPeriphery  ///< farther than 20 degrees from the gaze
};
inline constexpr std::size_t metric_count = 8;

struct MetricTraits {
  Metric metric{};
  const char* name = "";
  const char* title = "";  ///< with unit, for tables and figures
  int digits = 2;          ///< decimals
};
const std::array<MetricTraits, metric_count>& all_metrics();

/// One metric of one method: cells ordered by checkpoint, gaze point, repeat. A PSNR is infinite if the
/// compared pixels were equal; a value is NaN if its mask was too small.
struct Series {
  std::vector<stats::ImageScore> cells;
  std::size_t repeats = 1;  ///< consecutive cells that are not independent: repeats of one gaze point
};

struct MethodScores {
  sim::MethodKind method{};
  std::array<Series, metric_count> series;
  Series& of(Metric metric) { return series[static_cast<std::size_t>(metric)]; }
  const Series& of(Metric metric) const { return series[static_cast<std::size_t>(metric)]; }
};

/// Scores of the five methods for one scene, n_* (number of particles if all are coarsest) and preset, each
/// compared with HiRes, the method whose particles are all finest. HiRes from perturbed starts is compared
/// with HiRes from the unperturbed one.
struct ScoreBlock {
  std::string scene, n_star;
  sim::Preset preset{};
  std::vector<MethodScores> methods;
  std::vector<int> checkpoints = {};     ///< frames of the compared checkpoints
  std::vector<std::string> starts = {};  ///< checkpoint_digest() of each checkpoint, once known
  int gazes = 0;                         ///< gaze points per checkpoint
};

/// Columns scene, n_star, method, preset, metric, mean, ci_low, ci_high (95 %, Student's t over groups),
/// groups (checkpoint x gaze point, repeats averaged), cells (number of finite values), equal (number of
/// infinite values, left out of the mean), skipped (number of masks that were too small), pixels (mean size
/// of a mask).
figures::TextTable score_rows(const std::vector<ScoreBlock>& blocks);

/// The paper's layout: one row per method, one column per metric, mean +- half the interval's width.
figures::TextTable score_table(const std::vector<ScoreBlock>& blocks);

/// Paired differences with their intervals, and a check of the paper's order in PSNR@salient, PSNR@overall
/// and SSIM-static: it is broken if a mean is more than 0.1 dB (0.005 SSIM) on the wrong side. In the fovea
/// only Ours is checked: it may be 0.75 dB below FovFluid.
figures::TextTable paired_rows(const std::vector<ScoreBlock>& blocks);

/// SVG bars with intervals for one metric; empty if no method has values of it.
std::string score_chart(const std::vector<ScoreBlock>& blocks, const MetricTraits& metric);

}  // namespace measure
