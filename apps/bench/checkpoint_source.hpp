#pragma once
/// Where Table 1 has its checkpoints from: a run of HiRes, or the files of an earlier run.

#include <string>
#include <vector>

#include "apps/bench/checkpoint.hpp"
#include "apps/bench/onlooker.hpp"
#include "apps/bench/table1_options.hpp"

namespace apps {

/// The scene's checkpoints that the options ask for.
std::vector<int> checkpoint_frames(const CellScene& scene, const Table1Options& options);

/// Digests of those in --checkpoints-from; none where it is not given. base::Error unless it holds them all.
std::vector<std::string> stored_digests(const CellScene& scene, const CellSize& size,
                                        const Table1Options& options);

/// From --checkpoints-from, or else from HiRes, which runs from its settled state and is drawn by `eye`; then
/// also stored in --checkpoints-to.
std::vector<Checkpoint> take_checkpoints(const CellScene& scene, const CellSize& size,
                                         const Table1Options& options, Onlooker& eye);

}  // namespace apps
