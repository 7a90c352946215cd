#pragma once
/// Runs one cell of a sweep.

#include <vector>

#include "apps/common/sweep/cell_run.hpp"
#include "apps/common/sweep/matrix.hpp"

namespace apps {

WaterSample sample_of(double time_s, const std::vector<sim::ParticleState>& water);

/// base::Error if the simulation becomes unstable. Measurements are made between frames, outside the timing.
CellRun run_cell(const SweepCell& cell, const sim::Scene& scene, sim::Backend backend);

}  // namespace apps
