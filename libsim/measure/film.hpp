#pragma once
/// SSIM-cumul and both flickers of Table 1: all methods from frame 0 on, each frame against HiRes.

#include "libsim/measure/scores.hpp"
#include "libsim/measure/table1_options.hpp"

namespace measure {

/// Runs the methods in lockstep, with the gaze on the scene's keys, and adds Metric::SsimCumul (mean SSIM of
/// frames 1 .. cumul_frames), Metric::Flicker and Metric::FlickerPeriphery (means over frames 2 ..
/// cumul_frames) to the block's methods, one cell for each of film_starts. HiRes is compared with itself from
/// a perturbed settled state; from the second start on, all methods start from perturbed states. Needs a
/// current context.
void run_film(const sim::CellScene& scene, const CellSize& size, const Table1Options& options,
              ScoreBlock& block);

}  // namespace measure
