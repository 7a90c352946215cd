#pragma once
/// Runs one cell of a sweep.

#include <vector>

#include "libstudy/sweep/cell_run.hpp"
#include "libstudy/sweep/matrix.hpp"

namespace study {

/// Front, centre of mass and kinetic energy of these particles; density_error and density_max stay 0. A
/// particle's mass is 2^level.
WaterSample sample_of(double time_s, const std::vector<sim::ParticleState>& water);

/// Runs the cell. The state of the water is measured between frames, outside the timing. base::Error if the
/// simulation's state has non-finite values at the end.
CellRun run_cell(const SweepCell& cell, const sim::Scene& scene, sim::Backend backend);

}  // namespace study
