#pragma once
/// Compares what people may notice of frame timing on the answers of a study, and writes the result as JSON.

#include <optional>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/analysis/rivals/rival_data.hpp"
#include "stats/ordinal/rival_comparison.hpp"

namespace study {

/// Most timings for which a model with a free value for each is fitted beside the rivals.
inline constexpr std::size_t most_free_settings = 60;
inline constexpr const char* free_model = "free";  ///< name of this model
inline constexpr const char* no_declared_comparison = "no analysis plan declares a comparison of models";

/// The models as they are fitted: those given, then the model of nothing, then free_model if there are at
/// most most_free_settings timings.
std::vector<stats::RivalModel> rival_models(const RivalData& data, const std::vector<TimingModel>& models);

/// For each of rival_models() the fits without each group of people.
using RivalFits = std::vector<std::vector<stats::Result<stats::RivalFit>>>;

/// Fits and compares the models. The last model of the comparison is free_model, if there are at most
/// most_free_settings timings. why_no_comparison() must be empty for the data. `without`: the fits without
/// each group, if stats::fit_without_groups() has computed them. Refused as stats::compare_rivals().
stats::Result<stats::RivalComparison> compare_timing_models(const RivalData& data,
                                                            const std::vector<TimingModel>& models,
                                                            const stats::RivalComparisonOptions& options,
                                                            const RivalFits* without = nullptr);

/// Why the comparison is not confirmatory, in words: the plan does not declare it, or nothing shows that the
/// plan is older than the first answer. Empty: it is confirmatory. plan_rules: exclusions and seed are those
/// of the plan. frozen: the preregistration that holds the plan; none: the plan is a file of its own.
std::string why_exploratory(const RivalData& data, const std::vector<TimingModel>& models,
                            const stats::RivalComparisonOptions& options, bool plan_rules,
                            const PlanInForce& plan, const std::optional<FrozenFacts>& frozen);

/// The document of `vip-stats compare-models --json` (docs/statistics.md): every number that the command
/// prints. exploratory: what why_exploratory() says; if empty, the comparison is confirmatory, and the
/// verdict says whether the model that the plan expects predicts best.
Json compare_models_json(const RivalData& data, const std::vector<TimingModel>& models,
                         const stats::RivalComparisonOptions& options,
                         const stats::RivalComparison& comparison, const PlanInForce& plan = {},
                         const std::string& exploratory = no_declared_comparison);

}  // namespace study
