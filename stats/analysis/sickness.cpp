#include "stats/analysis/sickness.hpp"

#include <cmath>
#include <vector>

namespace stats {

namespace {

std::vector<double> weighted(std::span<const double> values, double weight) {
  std::vector<double> out;
  for (const double value : values) out.push_back(weight * value);
  return out;
}

std::vector<double> scores(std::span<const ExactMean> means, double weight) {
  std::vector<double> values;
  for (const ExactMean& mean : means) values.push_back(mean.value());
  return weighted(values, weight);
}

Result<SignedRank> rank_changes(const ExactDifferences& differences, double weight, double confidence) {
  const auto ranks = signed_rank(differences, confidence);
  if (!ranks) return ranks;
  SignedRank out = *ranks;
  out.hodges_lehmann *= weight;
  if (out.hodges_lehmann_ci) {
    for (double& end : *out.hodges_lehmann_ci) end *= weight;
  }
  return out;
}

}  // namespace

SicknessChange compare_sickness(std::span<const ExactMean> before, std::span<const ExactMean> after,
                                double weight, const AnalysisPlan& plan) {
  SicknessChange out;
  out.before = describe(scores(before, weight));
  out.after = describe(scores(after, weight));
  const auto differences = exact_differences(after, before);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int values = !std::isnan(before[i].sum) + !std::isnan(after[i].sum);
    out.n += values == 2 ? 1 : 0;
    out.n_missing += values == 1 ? 1 : 0;
  }
  if (!differences) {
    const Refusal refusal{differences.reason()};
    out.change = refusal;
    out.bootstrap = refusal;
    out.ranks = refusal;
    return out;
  }
  const std::vector<double> changes = weighted(differences->values(), weight);
  out.change = describe(changes);
  out.bootstrap =
      bootstrap_interval(changes, mean_statistic(),
                         {.resamples = plan.resamples, .seed = plan.seed, .confidence = plan.confidence});
  out.ranks = rank_changes(*differences, weight, plan.confidence);
  return out;
}

}  // namespace stats
