#pragma once
/// The cells of a comparison of timing models, and all its fits from their shards (analysis/shards.hpp).
///
/// JSON: "schema" is vip-compare-shard/1; "fits" is what the fits depend on; "outcomes" has for each group of
/// the cell [scores, thresholds, coefficients, sd_person, lapse, log_likelihood, parameters], the members of
/// stats::RivalFit, or the reason why there is no fit.

#include <filesystem>
#include <vector>

#include "libstudy/analysis/rivals/compare_models.hpp"
#include "libstudy/analysis/shards.hpp"

namespace study {

/// Fits of one model without some of the groups of people.
struct RivalCell : ListedCell {
  std::size_t model = 0;  ///< index into rival_models()
  stats::RivalGroups groups;
};

/// All cells, by model and group. In a cell, the people of all fits together are at most 50,000.
std::vector<RivalCell> rival_cells(const RivalData& data, const std::vector<TimingModel>& models,
                                   const stats::RivalComparisonOptions& options);

/// Computes the cell's fits and writes its shard, as write_shard().
void run_rival_cell(const RivalData& data, const std::vector<TimingModel>& models,
                    const stats::RivalComparisonOptions& options, const RivalCell& cell,
                    const std::filesystem::path& file);

/// All fits from the shards of the cells, as read_shards().
RivalFits join_rival_shards(const RivalData& data, const std::vector<TimingModel>& models,
                            const stats::RivalComparisonOptions& options,
                            const std::vector<std::filesystem::path>& files);

}  // namespace study
