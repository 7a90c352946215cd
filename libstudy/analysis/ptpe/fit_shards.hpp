#pragma once
/// The cells of the bootstrap of a pilot's fit, and all its resamples from their shards
/// (analysis/shards.hpp).
///
/// JSON: "schema" is vip-fit-shard/1; "resamples" is what the curves depend on; "outcomes" has one list for
/// each member of FitResamples: [a, b] or null for each resample of the cell, or an empty list.

#include <filesystem>
#include <vector>

#include "libstudy/analysis/ptpe/pilot_fit.hpp"
#include "libstudy/analysis/shards.hpp"

namespace study {

/// The arguments of fit_pilot().
struct FitRequest {
  TaskData data;
  double level = 4;
  stats::BootstrapOptions bootstrap;
  stats::PilotRules rules;
};

/// Consecutive resamples.
struct FitCell : ListedCell {
  stats::ResampleRange range;
};

/// All cells of a fit, by the number of the resample. A cell draws at most 100,000 participants.
std::vector<FitCell> fit_cells(const FitRequest& request);

/// Computes the cell's resamples and writes its shard, as write_shard().
void run_fit_cell(const FitRequest& request, const FitCell& cell, const std::filesystem::path& file);

/// All resamples of the fit from the shards of its cells, as read_shards().
FitResamples join_fit_shards(const FitRequest& request, const std::vector<std::filesystem::path>& files);

}  // namespace study
