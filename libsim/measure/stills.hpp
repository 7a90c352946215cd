#pragma once
/// The still cells of Table 1: from one state of HiRes to each method's picture a few frames later.

#include <functional>
#include <vector>

#include "libsim/measure/contact_sheet.hpp"
#include "libsim/measure/scores.hpp"
#include "libsim/measure/table1_options.hpp"

namespace measure {

/// Quality of a method's starts after projection.
struct StartQuality {
  sim::MethodKind method{};
  sim::Preset preset{};
  sim::RelaxedStart worst;     ///< largest number of projections, largest compression
  double particles_share = 0;  ///< mean of n / (8 n_*)
  int starts = 0;
};

struct StillResult {
  std::vector<ScoreBlock> blocks;  ///< one per preset
  std::vector<StartQuality> starts;
};

/// A block without values: the methods, checkpoints and number of repeats to compare.
ScoreBlock empty_block(const sim::CellScene& scene, const CellSize& size, sim::Preset preset,
                       const Table1Options& options);

/// Number of runs that run_stills() makes, for a progress line.
std::size_t still_runs(const sim::CellScene& scene, const Table1Options& options, std::size_t presets);

/// The protocol: HiRes runs from its settled state. At each checkpoint every method starts from that state,
/// coarsened to the method's targets and projected, looks at one gaze point and at the checkpoint's picture,
/// and is compared `frames_after` frames later with HiRes from the same checkpoint. Repeats perturb the state
/// by an ulp (checkpoint.hpp) and reseed the choice of active particles; HiRes from perturbed states gives
/// the floor set by chaos. Masks come from the HiRes picture and its saliency with tuned readings, the same
/// for all methods. Needs a current context; calls `done` after each run.
StillResult run_stills(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
                       const std::vector<sim::Preset>& presets, const std::function<void()>& done,
                       SheetWriter& sheets);

}  // namespace measure
