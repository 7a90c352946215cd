#pragma once
/// Gets the checkpoints of Table 1 from a run of HiRes, or from the files of an earlier run.

#include <string>
#include <vector>

#include "libsim/measure/checkpoint.hpp"
#include "libsim/measure/onlooker.hpp"
#include "libsim/measure/table1_options.hpp"

namespace measure {

/// Frames of the scene's checkpoints that the options ask for.
std::vector<int> checkpoint_frames(const sim::CellScene& scene, const Table1Options& options);

/// Digests of the checkpoints in --checkpoints-from; empty without the option. base::Error unless all are
/// there.
std::vector<std::string> stored_digests(const sim::CellScene& scene, const CellSize& size,
                                        const Table1Options& options);

/// Reads the checkpoints from --checkpoints-from, or else runs HiRes from its settled state, drawn by `eye`,
/// and also stores them in --checkpoints-to if given.
std::vector<Checkpoint> take_checkpoints(const sim::CellScene& scene, const CellSize& size,
                                         const Table1Options& options, Onlooker& eye);

}  // namespace measure
